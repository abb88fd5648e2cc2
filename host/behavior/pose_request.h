// Requests to the behavior `pose`, one line each.
// SPDX-License-Identifier: Apache-2.0
//
//   target JOINT RAD   turns the joint to this angle
//   play JSON          plays a pose file (motion/pose_sequence.h), on one line
//   stop               stops the pose file that is playing; every joint keeps its present angle
//   end                ends the behavior
#pragma once

#include <string>
#include <string_view>

#include "shared/base/result.hpp"

namespace kaz::behavior {

struct PoseRequest {
  enum class Kind { target, play, stop, end };
  Kind kind = Kind::stop;
  std::string text;      // name of the joint, or the pose file
  double angle_rad = 0;  // -pi to pi
};

// Error message of a run without a source of requests.
inline constexpr const char* kNoRequests =
    "`kaz run pose` needs --view and the virtual robot: give --view, and leave out --robot. For a "
    "robot at a port, use `kaz run play --poses FILE`";

// Fails (usage) if `line` is not a valid request. The message lists the valid forms.
Result<PoseRequest> parse_pose_request(std::string_view line);

}  // namespace kaz::behavior
