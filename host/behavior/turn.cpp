// turn-left and turn-right: by slip of the soles, closed on the gyro's heading where there is one.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/turn.h"

#include <cmath>

#include "host/behavior/walker.h"

namespace kaz::behavior {

namespace {

constexpr Option kOptions[] = {
    {"angle", "45", "", 1, 360, "degrees"},
    {"gyro", "use", "use|ignore", 0, 0, "ignore: turn as if the board had none"},
};

constexpr double kNear_deg = 4;  // that its own measure may miss the goal by

Result<Outcome> turn(Context& context, const Behavior& behavior, double sign) {
  motion::Settings settings;
  settings.use_gyro = context.options.choice("gyro") == "use";
  auto walker = Walker::begin(context, behavior.name, settings);
  if (!walker) return tl::unexpected(walker.error());
  const double angle_deg = context.options.number("angle");
  const motion::Motion& motion = walker->motion();
  const double start = motion.heading();
  const Time began = walker->input().now;
  if (!walker->fallen()) {
    walker->phase("turn");
    walker->motion().turn(sign * angle_deg * motion::kDegree);
    if (auto done = walker->finish(); !done) return tl::unexpected(done.error());
  }
  const double turned_deg = sign * (motion.heading() - start) / motion::kDegree;

  Outcome outcome;
  outcome.success = !walker->fallen() && std::abs(turned_deg - angle_deg) < kNear_deg;
  char text[160];
  std::snprintf(text, sizeof text, "the robot %s %.1f degrees%s",
                walker->fallen() ? "fell after" : "turned by", turned_deg,
                motion.has_gyro() ? "" : " by its strides (no gyro)");
  outcome.sentence = text;
  outcome.figures = {{"turned_deg", turned_deg},
                     {"sigma_heading_deg", motion.place().sigma_heading / motion::kDegree},
                     {"turning_s", seconds(walker->input().now - began)}};
  return outcome;
}

Result<Outcome> left(Context& context) {
  return turn(context, kTurnLeft, 1);
}
Result<Outcome> right(Context& context) {
  return turn(context, kTurnRight, -1);
}

}  // namespace

constinit const Behavior kTurnLeft{"turn-left", "turn to the left on the spot", false, kOptions,
                                   left};
constinit const Behavior kTurnRight{"turn-right", "turn to the right on the spot", false, kOptions,
                                    right};

}  // namespace kaz::behavior
