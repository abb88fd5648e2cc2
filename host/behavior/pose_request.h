// What may be asked of the behaviour `pose`, one line each.
// SPDX-License-Identifier: Apache-2.0
//
//   target JOINT RAD   the joint turns there
//   play JSON          a file of poses (motion/pose_sequence.h), on one line
//   stop               what is played ends; every joint stays where it is
//   end                the behaviour ends
#pragma once

#include <string>
#include <string_view>

#include "shared/base/result.hpp"

namespace kaz::behavior {

struct PoseRequest {
  enum class Kind { target, play, stop, end };
  Kind kind = Kind::stop;
  std::string text;      // the joint's name, or the poses
  double angle_rad = 0;  // -pi to pi
};

// Of a run that nobody can make requests of.
inline constexpr const char* kNoRequests =
    "pose: joints are set on the page of --view, and of the virtual robot alone: give --view and "
    "no "
    "--robot; a robot at a port plays files: kaz run play --poses FILE";

// Errors (usage) state what was expected.
Result<PoseRequest> parse_pose_request(std::string_view line);

}  // namespace kaz::behavior
