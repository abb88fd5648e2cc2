// stand: enables the motors and ramps all joints linearly to a posture, none faster than 0.5 rad/s.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/behavior/control_cycle.h"
#include "host/motion/gait.h"

namespace kaz::behavior {

namespace {

using host::JointAngles;

constexpr Option kOptions[] = {
    {"posture", "keep", "keep|straight|home", 0, 0,
     "keep: the present posture; straight: all joints at zero; home: the walking crouch"}};

constexpr double kSpeed = 0.5;                     // rad/s, of the joint with the longest path
constexpr Time kSettle = std::chrono::seconds(3);  // after the ramps; it is to stay there
constexpr double kTolerance = 5 * std::numbers::pi / 180;  // of each joint under load

std::vector<host::JointTarget> all_to(const JointAngles& goal) {
  std::vector<host::JointTarget> targets;
  for (int j = 0; j < KZ_JOINTS; ++j) targets.push_back({j, goal[static_cast<std::size_t>(j)]});
  return targets;
}

struct Worst {
  std::size_t joint = 0;
  double error_rad = 0;
};

Worst farthest(const JointAngles& from, const JointAngles& to, std::size_t joints = KZ_JOINTS) {
  Worst worst;
  for (std::size_t j = 0; j < joints; ++j) {
    if (std::abs(to[j] - from[j]) >= std::abs(worst.error_rad)) worst = {j, to[j] - from[j]};
  }
  return worst;
}

Result<Outcome> run(Context& context) {
  const std::vector<std::string>& others = context.other_joints;
  if (const std::string& chosen = context.options.choice("posture");
      !others.empty() && chosen != "keep") {
    std::string names;
    for (const std::string& name : others) names += (names.empty() ? "" : ", ") + name;
    return fail(Fault::usage, "the posture `" + chosen +
                                  "` is only valid for Kaz, and this robot has the joints " +
                                  names + "; use posture=keep");
  }
  KAZ_TRY(hold_still(context.robot));
  const auto start = KAZ_TRY(context.robot.state());
  const std::string& posture = context.options.choice("posture");
  context.sink.phase(context.clock.now(), kStand.name, "move");

  JointAngles goal = start.angle;
  if (posture != "keep") goal = posture == "home" ? motion::home() : JointAngles{};
  ControlCycle cycle(context);
  host::Posture last = start;
  bool begin = true;  // also after a lost link, which ends all ramps
  Time end{};
  while (begin || context.clock.now() < end) {
    const Time duration = from_seconds(std::abs(farthest(last.angle, goal).error_rad) / kSpeed);
    std::vector<host::JointTarget> targets;
    if (begin && posture != "keep") targets = all_to(goal);
    if (begin) end = context.clock.now() + (targets.empty() ? Time::zero() : duration) + kSettle;
    const auto input = KAZ_TRY(cycle.next(targets, duration));
    begin = input.resumed.has_value();
    last = input.posture;
  }

  const Worst worst =
      farthest(last.angle, goal,
               others.empty() ? KZ_JOINTS : std::min<std::size_t>(KZ_JOINTS, others.size()));
  const double degrees = std::abs(worst.error_rad) * 180 / std::numbers::pi;
  Outcome outcome;
  outcome.success = std::abs(worst.error_rad) <= kTolerance;
  char text[160];
  std::snprintf(
      text, sizeof text, "%s: %s has the largest error, %.1f degrees",
      outcome.success ? "the robot stands" : "the robot does not hold the posture",
      others.empty() ? host::joint_table()[worst.joint].name : others[worst.joint].c_str(),
      degrees);
  outcome.sentence = text;
  if (!outcome.success) outcome.cause = "not reached";
  outcome.measurements = {{"largest_joint_error_deg", degrees}};
  return outcome;
}

}  // namespace

constinit const Behavior kStand{.name = "stand",
                                .text = "switch all motors on and move slowly into a posture",
                                .options = kOptions,
                                .run = run,
                                .evaluation = {.criterion = Criterion::upright, .walks = false}};

}  // namespace kaz::behavior
