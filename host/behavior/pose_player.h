// Plays poses on a robot: what `play` and `pose` have in common.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/behavior/control_cycle.h"
#include "host/motion/pose_sequence.h"

namespace kaz::behavior {

// Names of the robot's joints, by number.
std::vector<std::string> joint_names(const Context& context);

class PosePlayer {
 public:
  static constexpr double kSlow_rad_per_s = 0.8;  // to the first pose

  // The context must outlive this. Motors must be on.
  explicit PosePlayer(Context& context) : context_(context), cycle_(context) {}

  // Errors (usage): beyond the limits of angle or speed that the board states, with joint and time.
  Result<void> check(const motion::PoseMotion& motion);

  struct Followed {
    double farthest_rad = 0;  // of a joint from where it was to be, while the motion went on
    int farthest = 0;         // that joint
    double farthest_s = 0;    // and when, in the motion's time
    double left_rad = 0;      // at the end, kSettle after it
    int left = 0;             // the joint that is farthest from its place then
    bool stopped = false;     // by `stop`, before the end
  };
  // Slowly to where the motion begins, then through it. `stop` is asked in each cycle. While the link is lost
  // the motion waits.
  Result<Followed> play(const motion::PoseMotion& motion, const std::function<bool()>& stop = {});

  // One control cycle with these targets, or none.
  Result<ControlCycle::Input> cycle(std::span<const host::JointTarget> targets, Time ramp) {
    return cycle_.next(targets, ramp);
  }

 private:
  Result<bool> approach(const motion::PoseMotion& motion, const std::function<bool()>& stop);

  Context& context_;
  ControlCycle cycle_;
};

}  // namespace kaz::behavior
