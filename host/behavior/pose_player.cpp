// Plays poses on a robot.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/pose_player.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kaz::behavior {

namespace {

constexpr Time kSettle = std::chrono::milliseconds(500);

}  // namespace

std::vector<std::string> joint_names(const Context& context) {
  if (!context.other_joints.empty()) return context.other_joints;
  std::vector<std::string> names;
  for (const host::JointInfo& joint : host::joint_table()) names.emplace_back(joint.name);
  return names;
}

Result<void> PosePlayer::check(const motion::PoseMotion& motion) {
  constexpr double kUnit = 1.0 / KZ_ANGLE_PER_RAD;  // the board rounds to it
  const auto names = joint_names(context_);
  for (const auto& extent : motion.extents()) {
    const auto settings = KAZ_TRY(context_.robot.settings(extent.joint));
    const std::string& name = names[static_cast<std::size_t>(extent.joint)];
    const auto [ramp, lower, upper] = settings.limits;
    approach_rad_per_s_[static_cast<std::size_t>(extent.joint)] = std::min(ramp, kSlow_rad_per_s);
    char text[200];
    if (extent.lowest_rad < lower - kUnit || extent.highest_rad > upper + kUnit) {
      std::snprintf(text, sizeof text,
                    "the poses turn %s to %.4g rad, but the joint's range is %.4g to %.4g rad: "
                    "change this angle",
                    name.c_str(),
                    extent.lowest_rad < lower - kUnit ? extent.lowest_rad : extent.highest_rad,
                    lower, upper);
      return fail(Fault::usage, text);
    }
    if (extent.fastest_rad_per_s > ramp) {
      std::snprintf(text, sizeof text,
                    "the poses turn %s too fast (%.1f rad/s at the time %.2f s); the board allows "
                    "%.1f rad/s: leave more time between the poses",
                    name.c_str(), extent.fastest_rad_per_s, extent.fastest_at_s, ramp);
      return fail(Fault::usage, text);
    }
  }
  return {};
}

// False: stopped.
Result<bool> PosePlayer::approach(const motion::PoseMotion& motion,
                                  const std::function<bool()>& stop) {
  const auto targets = motion.at(0);
  bool begin = true;  // also after a lost link, which ends all ramps
  Time end{};
  host::Posture last = KAZ_TRY(context_.robot.state());
  while (begin || context_.clock.now() < end) {
    double longest_s = 0;
    for (const auto& [joint, angle] : targets) {
      const auto j = static_cast<std::size_t>(joint);
      longest_s = std::max(longest_s, std::abs(angle - last.angle[j]) / approach_rad_per_s_[j]);
    }
    const Time duration = from_seconds(longest_s);
    if (begin) end = context_.clock.now() + duration + kSettle;
    const auto input = KAZ_TRY(cycle_.next(
        begin ? std::span<const host::JointTarget>(targets) : std::span<const host::JointTarget>(),
        duration));
    begin = input.resumed.has_value();
    last = input.posture;
    if (stop && stop()) return false;
  }
  return true;
}

Result<PosePlayer::Followed> PosePlayer::play(const motion::PoseMotion& motion,
                                              const std::function<bool()>& stop) {
  Followed followed;
  if (!KAZ_TRY(approach(motion, stop))) {
    followed.stopped = true;
    return followed;
  }
  Time begin = context_.clock.now(), before = begin;
  Time ramp = ControlCycle::kRamp;
  const Time length = from_seconds(motion.end_s());
  const auto distance = [](const host::JointTarget& target, const host::Posture& posture) {
    return std::abs(target.angle_rad - posture.angle[static_cast<std::size_t>(target.joint)]);
  };
  for (Time now = begin; now - begin < length + kSettle;) {
    // The ramp that leaves now ends after that long.
    const Time reached = now - begin + ControlCycle::kSendDelay + ramp;
    const auto input = KAZ_TRY(cycle_.next(motion.at(seconds(reached)), ramp));
    now = input.now;
    // Ramps that last a little longer than the cycle, so that none ends before the next begins.
    ramp = std::clamp<Time>(now - before + std::chrono::milliseconds(2), ControlCycle::kRamp,
                            std::chrono::milliseconds(60));
    if (input.resumed) begin += now - before;
    before = now;
    const double at_s = seconds(input.posture.time - begin);
    followed.left_rad = 0;
    for (const host::JointTarget& target : motion.at(at_s)) {
      const double error = distance(target, input.posture);
      if (error > followed.farthest_rad && at_s <= motion.end_s()) {
        followed.farthest_rad = error;
        followed.farthest = target.joint;
        followed.farthest_s = std::max(0.0, at_s);
      }
      if (error >= followed.left_rad) {
        followed.left_rad = error;
        followed.left = target.joint;
      }
    }
    if (stop && stop()) {
      followed.stopped = true;
      break;
    }
  }
  return followed;
}

}  // namespace kaz::behavior
