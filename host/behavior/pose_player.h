// Plays poses on a robot. Shared by the behaviors `play` and `pose`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "host/behavior/control_cycle.h"
#include "host/motion/pose_sequence.h"

namespace kaz::behavior {

// Returns the names of the robot's joints, indexed by joint number.
std::vector<std::string> joint_names(const Context& context);

class PosePlayer {
 public:
  // Largest speed of the approach to the first pose.
  static constexpr double kSlow_rad_per_s = 0.8;

  // The context must outlive this object. The motors must be on before play().
  explicit PosePlayer(Context& context) : context_(context), cycle_(context) {
    approach_rad_per_s_.fill(kSlow_rad_per_s);
  }

  // Also bounds the approach to the first pose by the board's limits of speed.
  // Errors (usage): an angle or a speed exceeds the board's limits; the message names the joint. Also returns
  // the errors of the link.
  Result<void> check(const motion::PoseMotion& motion);

  struct Followed {
    // Largest position error of all joints during the motion.
    double farthest_rad = 0;
    int farthest = 0;       // joint with the error farthest_rad
    double farthest_s = 0;  // time of the error farthest_rad, from the start of the motion
    // Largest position error of all joints in the last cycle. If the motion was not stopped early, its last
    // cycle is 0.5 s after the last pose.
    double left_rad = 0;
    int left = 0;          // joint with the error left_rad
    bool stopped = false;  // true: `stop` ended the motion early
  };
  // Moves slowly to the first pose, then plays the motion. `stop` is called in each cycle and ends the motion
  // if it returns true. While the link is lost, the motion waits.
  Result<Followed> play(const motion::PoseMotion& motion, const std::function<bool()>& stop = {});

  // Runs one control cycle with `targets` (ControlCycle::next). `targets` may be empty.
  Result<ControlCycle::Input> cycle(std::span<const host::JointTarget> targets, Time ramp) {
    return cycle_.next(targets, ramp);
  }

 private:
  // Moves slowly to the first pose. Returns false if `stop` ended the approach.
  Result<bool> approach(const motion::PoseMotion& motion, const std::function<bool()>& stop);

  Context& context_;
  ControlCycle cycle_;
  std::array<double, KZ_JOINTS> approach_rad_per_s_{};  // indexed by joint
};

}  // namespace kaz::behavior
