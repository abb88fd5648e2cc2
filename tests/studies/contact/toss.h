// Recorded tosses of a cube: poses at a fixed rate, and the velocities of each sample.
// SPDX-License-Identifier: Apache-2.0
//
// Data: DAIRLab, dairlib and contact-nets, BSD-3-Clause. A file NUMBER.csv has one line per sample.
// The 13 columns of a line:
//    1 to 3   position, half edges of the cube
//    4 to 7   quaternion w x y z
//    8 to 10  velocity, half edges/s
//   11 to 13  angular velocity, rad/s, body axes
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"

namespace kaz::contact {

inline constexpr double kHalf = 0.0524;   // half edge of the cube, m
inline constexpr double kRate = 148;      // samples per second
inline constexpr double kGravity = 9.81;  // m/s2

// Pose of the cube's center, world axes, z up.
struct Pose {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

// Poses at the times 0, 1 / kRate, 2 / kRate and so on.
using Path = std::vector<Pose>;

struct Toss {
  int number = 0;  // number in the file name
  Path path;
  // Velocity (m/s) and angular velocity (rad/s) of each sample, world axes.
  std::vector<Eigen::Vector3d> velocity, spin;
};

// Reads NUMBER.csv with 10 to 10,000 samples. Returns Fault::usage with file and line for a bad file. Each
// line must have 13 finite numbers in range. The length of a quaternion must be 1 within 0.001.
Result<Toss> read_toss(const std::string& path);

// Reads all NUMBER.csv files of a folder, sorted by number. The function skips files with other extensions.
// Returns Fault::usage if there are fewer than 8 or more than 10,000 files. A bad file or a number that
// occurs twice is also Fault::usage.
Result<std::vector<Toss>> read_tosses(const std::string& folder);

// Writes a file that read_toss() reads, with 9 decimals.
Result<void> write_toss(const std::string& folder, const Toss& toss);

// Subtracts half a sample of gravity from each upward velocity. The recorded velocity is the difference to
// the previous position, so it is the velocity half a sample earlier.
void correct_velocities(std::vector<Toss>& tosses);

}  // namespace kaz::contact
