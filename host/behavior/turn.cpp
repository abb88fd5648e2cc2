// turn-left and turn-right: on the spot by slip of the soles, and by the gyro's heading if fitted.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "host/behavior/walker.h"
#include "shared/base/angle.hpp"

namespace kaz::behavior {

namespace {

constexpr double kNear_deg = 4;  // tolerance of the measured angle
// Within the tolerance standing still would succeed.
constexpr double kSmallest_deg = 5;

constexpr Option kOptions[] = {
    {"angle", "45", "", kSmallest_deg, 360, "degrees"},
    {"gyro", "use", "use|ignore", 0, 0, "ignore: turn as if the board had no gyro"},
};

Result<Outcome> turn(Context& context, const Behavior& behavior, double sign) {
  motion::Settings settings;
  settings.use_gyro = context.options.choice("gyro") == "use";
  auto walker = KAZ_TRY(Walker::begin(context, behavior.name, settings));
  const double angle_deg = context.options.number("angle");
  const motion::Motion& motion = walker.motion();
  const double start = motion.heading();
  const Time began = walker.input().now;
  if (!walker.fallen()) {
    walker.phase("turn");
    walker.motion().turn(sign * angle_deg * kDegree);
    KAZ_TRY(walker.finish());
  }
  double turned_deg = sign * (motion.heading() - start) / kDegree;
  if (std::abs(turned_deg) < 0.05) turned_deg = 0;  // prints as 0.0, not as -0.0

  Outcome outcome;
  outcome.success = !walker.fallen() && std::abs(turned_deg - angle_deg) < kNear_deg;
  char text[160];
  std::snprintf(text, sizeof text, "the robot %s %.1f degrees%s",
                walker.fallen() ? "fell after" : "turned by", turned_deg,
                motion.has_gyro() ? "" : " (measured by the robot's strides, without a gyro)");
  outcome.sentence = text;
  if (!outcome.success) outcome.cause = walker.fallen() ? "fell" : "not reached";
  outcome.measurements = {{"turned_deg", turned_deg},
                          {"sigma_heading_deg", motion.place().sigma_heading / kDegree},
                          {"turning_s", seconds(walker.input().now - began)}};
  return outcome;
}

Result<Outcome> left(Context& context) {
  return turn(context, kTurnLeft, 1);
}
Result<Outcome> right(Context& context) {
  return turn(context, kTurnRight, -1);
}

}  // namespace

constinit const Behavior kTurnLeft{.name = "turn-left",
                                   .text = "turn to the left on the spot",
                                   .options = kOptions,
                                   .run = left,
                                   .evaluation = {.criterion = Criterion::turned_left}};
constinit const Behavior kTurnRight{.name = "turn-right",
                                    .text = "turn to the right on the spot",
                                    .options = kOptions,
                                    .run = right,
                                    .evaluation = {.criterion = Criterion::turned_right}};

}  // namespace kaz::behavior
