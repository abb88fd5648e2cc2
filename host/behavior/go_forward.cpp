// go-forward: walks straight by odometry of the supporting feet, and by the gyro's heading if fitted.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "host/behavior/walker.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

constexpr Option kOptions[] = {
    {"distance", "0.5", "", -2, 5, "metres ahead, 0.05 at least; negative: back"},
    {"gyro", "use", "use|ignore", 0, 0, "ignore: walk as if the board had none"},
};

constexpr double kNear = 0.03;         // m, tolerance of the distance by odometry
constexpr double kMinDistance = 0.05;  // m; within the tolerance standing still would succeed

Result<Outcome> run(Context& context) {
  if (std::abs(context.options.number("distance")) < kMinDistance - 1e-9)
    return fail(
        Fault::usage,
        "go-forward: distance is too short to walk; give at least 0.05 m, or -0.05 m for back");
  motion::Settings settings;
  settings.use_gyro = context.options.choice("gyro") == "use";
  auto walker = KAZ_TRY(Walker::begin(context, kGoForward.name, settings));
  const double distance = context.options.number("distance");
  const motion::Motion& motion = walker.motion();
  const double start = motion.walked(), heading = motion.heading();
  const Time began = walker.input().now;
  if (!walker.fallen()) {
    walker.phase("walk");
    walker.motion().walk(distance);
    KAZ_TRY(walker.finish());
  }
  const double walked = motion.walked() - start;
  const double turned = (motion.heading() - heading) / kDegree;
  const motion::Place place = motion.place();

  Outcome outcome;
  outcome.success = !walker.fallen() && std::abs(walked - distance) < kNear;
  char text[160];
  std::snprintf(text, sizeof text, "the robot %s %.2f m, %.1f degrees off its heading%s",
                walker.fallen() ? "fell after" : "walked", walked, turned,
                motion.has_gyro() ? "" : " by its strides (no gyro)");
  outcome.sentence = text;
  if (!outcome.success) outcome.cause = walker.fallen() ? "fell" : "not reached";
  outcome.measurements = {{"walked_m", walked},
                          {"turned_deg", turned},
                          {"ahead_m", place.x},
                          {"aside_m", place.y},
                          {"sigma_along_m", place.sigma_along},
                          {"sigma_across_m", place.sigma_across},
                          {"sigma_heading_deg", place.sigma_heading / kDegree},
                          {"walking_s", seconds(walker.input().now - began)}};
  return outcome;
}

}  // namespace

constinit const Behavior kGoForward{"go-forward", "walk straight ahead for a distance", false,
                                    kOptions, run};

}  // namespace kaz::behavior
