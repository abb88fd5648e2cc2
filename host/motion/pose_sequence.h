// Poses over time, read from a file or sent by the browser page of --view, and a smooth motion through them.
// SPDX-License-Identifier: Apache-2.0
//
// A pose file (docs/howto/watch.md) is JSON:
//
//   {"format": "kaz-poses-1",
//    "poses": [{"time_s": 0, "angles_rad": {"r_sh_pitch": 0}},
//              {"time_s": 1.5, "angles_rad": {"r_sh_pitch": -0.8, "neck_pan": 0.3}}]}
//
// A pose need not contain all joints. A pose has no effect on joints that it does not contain. Between two
// successive poses that contain a joint, the joint moves from its angle in the earlier pose to its angle in
// the later pose. Before the first pose that contains a joint, the joint does not move. After the last pose
// that contains a joint, the joint stays at its last angle. If no pose contains a joint, this joint does not
// move.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/robot/robot_types.h"
#include "shared/base/result.hpp"

namespace kaz::motion {

inline constexpr std::size_t kMaxPoses = 1000, kMaxPosesBytes = 1 << 20;
inline constexpr double kMaxPosesTime_s = 600;

struct Pose {
  double time_s = 0;
  std::vector<std::pair<std::string, double>> angles_rad;  // joint name, angle
};

struct PoseSequence {
  std::vector<Pose> poses;  // one or more poses, in order of time
};

// Parses a pose file. `name`: the file's name in messages. Errors (usage): the text is not a valid pose
// file, or times do not increase.
Result<PoseSequence> parse_poses(std::string_view text, const std::string& name);
// Returns the text of a pose file for this sequence, on one line.
std::string text_of(const PoseSequence& sequence);

// Angles over time: monotone cubic pieces (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984). At the
// start and at the end, all joints are at rest. Between two poses, the angle of a joint never leaves the
// range between its angles in these two poses.
class PoseMotion {
 public:
  // `joints`: joint names, indexed by joint number. Fails (usage) if the sequence contains a joint that is
  // not in `joints`.
  static Result<PoseMotion> create(const PoseSequence& sequence,
                                   std::span<const std::string> joints);

  double end_s() const { return end_s_; }
  // Returns the targets at `time_s`, for the joints that the poses contain.
  std::vector<host::JointTarget> at(double time_s) const;

  struct Extent {
    int joint = 0;
    double lowest_rad = 0, highest_rad = 0;
    double fastest_rad_per_s = 0, fastest_at_s = 0;
  };
  // Returns the extremes of angle and speed for each joint that the poses contain.
  std::vector<Extent> extents() const;

 private:
  struct Knot {
    double time_s, angle_rad, slope;  // slope in rad/s
  };
  struct Track {
    int joint = 0;
    std::vector<Knot> knots;
  };
  static void set_slopes(std::vector<Knot>& knots);
  std::vector<Track> tracks_;
  double end_s_ = 0;
};

}  // namespace kaz::motion
