// Crouches, zeroes the gyro, then runs control cycles.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/walker.h"

#include <algorithm>
#include <cmath>

namespace kaz::behavior {

namespace {

constexpr double kSpeed = 0.5;  // rad/s into the crouch, of the joint with the longest path
constexpr double kRamp = 12;    // rad/s, limit of commanded angles: swinging legs need 5
constexpr Time kSettle = std::chrono::milliseconds(500);
// Averaging time of the gyro's offset, which is then known to 0.04 degrees/s: 0.7 degrees in a metre's
// walk of 20 s.
constexpr double kZeroed_s = 4.0;

}  // namespace

Walker::Walker(Context& context, std::string_view behavior, const motion::Settings& settings)
    : context_(&context), behavior_(behavior), motion_(settings), cycle_(context) {}

Result<Walker> Walker::begin(Context& context, std::string_view behavior,
                             const motion::Settings& settings) {
  if (!context.other_joints.empty())
    return fail(Fault::usage, std::string(behavior) + " needs Kaz's legs, and this robot has none");
  KAZ_TRY(hold_still(context.robot));
  if (auto set = context.robot.set_limits(host::kAllJoints, {.ramp_rad_per_s = kRamp}); !set)
    return tl::unexpected(set.error());
  const auto inertial = KAZ_TRY(context.robot.sense_inertial());
  Walker walker(context, behavior, settings);
  walker.input_.now = context.clock.now();
  walker.phase("crouch");
  KAZ_TRY(walker.crouch());
  walker.phase("stand");
  // Motion starts averaging 0.6 s after it stands.
  const bool zero = inertial && settings.use_gyro;
  KAZ_TRY(walker.stay(kSettle + from_seconds(zero ? 0.6 + kZeroed_s : 0)));
  return walker;
}

Result<void> Walker::crouch() {
  const auto start = KAZ_TRY(context_->robot.state());
  const host::JointAngles goal = motion::home();
  std::vector<host::JointTarget> targets;
  double farthest = 0;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if (j == host::neck_pan || j == host::neck_tilt) continue;  // the caller's
    const auto joint = static_cast<std::size_t>(j);
    targets.push_back({j, goal[joint]});
    farthest = std::max(farthest, std::abs(goal[joint] - start.angle[joint]));
  }
  const Time duration = from_seconds(farthest / kSpeed);
  Time end{};
  for (bool begin = true; begin || input_.now < end;) {
    if (begin) end = context_->clock.now() + duration + kSettle;
    auto input = cycle_.next(begin ? targets : std::vector<host::JointTarget>{}, duration);
    if (!input) return tl::unexpected(input.error());
    input_ = std::move(*input);
    begin = input_.resumed.has_value();  // a lost link ends all ramps
  }
  return {};
}

Result<void> Walker::stay(Time duration) {
  const Time end = input_.now + duration;
  while (input_.now < end && !fallen())
    if (auto done = step(); !done) return done;
  return {};
}

Result<void> Walker::step(std::span<const host::JointTarget> others) {
  const auto legs = motion_.step(input_.now, input_.posture);
  if (fallen()) {
    phase("fallen");
    return context_->robot.enable(0);
  }
  std::vector<host::JointTarget> targets(legs.begin(), legs.end());
  targets.insert(targets.end(), others.begin(), others.end());
  return cycle_.advance(targets, input_);
}

Result<void> Walker::finish() {
  while (!motion_.idle() && !fallen())
    if (auto done = step(); !done) return done;
  return stay(kSettle);
}

}  // namespace kaz::behavior
