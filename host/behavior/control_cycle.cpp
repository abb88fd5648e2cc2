// One round trip and one poll of vision per control cycle.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/control_cycle.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace kaz::behavior {

namespace {

constexpr double kRampFactor = 1.15;  // ramp duration over cycle duration, in advance()
constexpr Time kMaxRamp = std::chrono::milliseconds(40);

std::string listed(std::span<const std::string> names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

ControlCycle::ControlCycle(Context& context)
    : context_(context), cycle_start_(context.clock.now()), last_image_(cycle_start_) {}

Result<ControlCycle::Input> ControlCycle::next(std::span<const host::JointTarget> targets,
                                               Time ramp) {
  Input input;
  const auto posture = KAZ_TRY(context_.robot.exchange(targets, ramp));
  input.resumed = context_.robot.take_resumption();
  if (posture.status & host::kMotorsOffFaults) {
    return fail(host::shutdown_fault(posture.status),
                context_.robot.describe_fault(posture.status));
  }
  input.posture = posture;

  // A late cycle is not caught up.
  cycle_start_ = std::max(cycle_start_ + kPeriod, context_.clock.now());
  KAZ_TRY(context_.clock.sleep_until(cycle_start_));
  input.now = context_.clock.now();
  if (!context_.vision) return input;

  auto observations = KAZ_TRY(context_.vision->poll(input.now));
  input.observations = std::move(observations);
  // While the link was sought nobody took pictures.
  if (!input.observations.empty() || input.resumed) last_image_ = input.now;
  if (input.now - last_image_ > context_.camera_patience) {
    char text[40];
    std::snprintf(text, sizeof text, "no image came for %.3g s: check ",
                  seconds(context_.camera_patience));
    return fail(Fault::environment, text + context_.camera);
  }
  return input;
}

Result<void> ControlCycle::advance(std::span<const host::JointTarget> targets, Input& input) {
  const Time before = input.now;
  const Time ramp = from_seconds(kRampFactor * seconds(duration_));
  auto newest = KAZ_TRY(next(targets, std::clamp(ramp, kRamp, kMaxRamp)));
  input = std::move(newest);
  duration_ = input.now - before;
  return {};
}

PictureRow picture_row(const vision::BallObservation& observation) {
  PictureRow row;
  row.exposure = observation.info.exposure;
  row.found = observation.found;
  if (!observation.found) return row;
  row.error_rad = std::acos(std::clamp(observation.direction.z(), -1.0, 1.0));
  row.distance_m = observation.distance_m;
  return row;
}

Result<void> require_joints(const Context& context, std::string_view behavior,
                            std::initializer_list<host::Joint> joints) {
  const std::vector<std::string>& others = context.other_joints;
  if (others.empty()) return {};
  std::vector<std::string> missing;
  for (const host::Joint joint : joints) {
    const std::string name = host::joint_table()[static_cast<std::size_t>(joint)].name;
    if (std::ranges::find(others, name) == others.end()) missing.push_back(name);
  }
  if (missing.empty()) return {};
  return fail(Fault::usage, std::string(behavior) + " moves " + listed(missing) +
                                ", but this robot has only " + listed(others) +
                                "; use a behavior for this robot's joints, or `stand`");
}

Result<void> hold_still(host::Robot& robot) {
  constexpr std::uint32_t kHands = 1u << host::l_hand | 1u << host::r_hand;
  constexpr std::uint32_t kNeck = 1u << host::neck_pan | 1u << host::neck_tilt;
  // Gait and catch are tuned with these, stiffer and more damped than the board's after a reset. The neck
  // carries no load: with a higher gain it would hunt in the backlash of its gears.
  constexpr host::Gains kBody{.kp_per_rad = 20, .kd_s_per_rad = 0.15};
  constexpr host::Gains kJaws{.kp_per_rad = 0.8, .kd_s_per_rad = 0.15};
  constexpr host::Gains kHead{.kp_per_rad = 12, .kd_s_per_rad = 0.15};
  if (auto set = robot.set_gains(host::kAllJoints & ~kHands & ~kNeck, kBody); !set) return set;
  if (auto set = robot.set_gains(kHands, kJaws); !set) return set;
  if (auto set = robot.set_gains(kNeck, kHead); !set) return set;
  return robot.enable(host::kAllJoints);
}

}  // namespace kaz::behavior
