// Joints of a robot other than Kaz, and unused elements of files of robot and world.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tools/run/backend_options.h"

namespace kaz::sim {
struct RobotModel;
}

namespace kaz::tools {

// Returns the joint names of `robot` in the order of the board's channels. Returns an empty list for Kaz.
// Fails (usage) if the robot has more joints than the board has channels. `robot_file`: for this error.
Result<std::vector<std::string>> other_joints(const sim::RobotModel& robot,
                                              const std::string& robot_file);

// Returns the speed limits of these joints as text, rad/s: at most 12, the board's largest ramp. Returns an
// empty list if no joint has a lower limit.
std::vector<std::string> joint_speeds(const sim::RobotModel& robot);
// Parses such a list. Fails (usage) if a text is not a number above 0.
Result<std::vector<double>> parse_speeds(const std::vector<std::string>& texts);

// Files whose unused elements print_unused() reports.
struct ReadFiles {
  std::string robot_file;  // URDF; empty: Kaz
  std::string world;       // SDF file; a name of one of Kaz's worlds, or empty: not reported
  sim::ReadOptions reading;
  bool verbose = false;
  // The robot of robot_file, if it has been read already; otherwise null.
  const sim::RobotModel* robot = nullptr;
};
ReadFiles files_of(const BackendOptions& options);

// Prints the elements that Kaz does not use to standard error. Each line begins with `label`. Without
// `verbose`, prints one line for each file, and may leave out elements of the robot's links. Prints nothing
// for an invalid file or with ReadOptions::strict, because loading the file then fails.
void print_unused(const std::string& label, const ReadFiles& files);

}  // namespace kaz::tools
