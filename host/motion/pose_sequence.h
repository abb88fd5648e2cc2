// Poses in time, as people and the page of --view write them, and the smooth motion through them.
// SPDX-License-Identifier: Apache-2.0
//
// A file of poses (docs/reference/poses.md) is JSON:
//
//   {"format": "kaz-poses-1",
//    "poses": [{"time_s": 0, "angles_rad": {"r_sh_pitch": 0}},
//              {"time_s": 1.5, "angles_rad": {"r_sh_pitch": -0.8, "neck_pan": 0.3}}]}
//
// A joint moves through the poses that name it, and does not move before the first and after the last of
// these. A joint that none names is left where it is.
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
  std::vector<std::pair<std::string, double>> angles_rad;  // by joint
};

struct PoseSequence {
  std::vector<Pose> poses;  // at least one, in the order of time
};

// `name`: of the file, for messages. Errors (usage): it is no such file; times that do not increase.
Result<PoseSequence> parse_poses(std::string_view text, const std::string& name);
// As parse_poses() reads it, on one line.
std::string text_of(const PoseSequence& sequence);

// Angles over time: monotone cubic pieces (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984), at rest
// at both ends. A joint is never outside the angles of the two poses that it is between.
class PoseMotion {
 public:
  // `joints`: names by joint number. Errors (usage): one is not among them.
  static Result<PoseMotion> create(const PoseSequence& sequence,
                                   std::span<const std::string> joints);

  double end_s() const { return end_s_; }
  // Where the joints are to be at that time, those that the poses name.
  std::vector<host::JointTarget> at(double time_s) const;

  struct Extent {
    int joint = 0;
    double lowest_rad = 0, highest_rad = 0;
    double fastest_rad_per_s = 0, fastest_at_s = 0;
  };
  // What is asked of each of these joints.
  std::vector<Extent> extents() const;

 private:
  struct Knot {
    double time_s, angle_rad, slope;  // slope: rad/s
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
