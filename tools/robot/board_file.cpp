// Adapts a robot's joint limits to the channels of the servo board.
// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/board_file.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "shared/base/files.hpp"
#include "shared/board/table.h"

namespace kaz::tools {
namespace {

constexpr double kRadPerUnit = 1e-4;  // unit of the board's table
constexpr double kMinRange = 0.1;     // rad

std::filesystem::path board_file_path(const std::string& urdf_path) {
  return std::filesystem::path(urdf_path).replace_extension(".board.urdf");
}

// Returns whether `path` exists and was written after `source`.
bool is_newer(const std::filesystem::path& path, const std::string& source) {
  std::error_code missing, ignored;
  const auto written = std::filesystem::last_write_time(path, missing);
  return !missing && written >= std::filesystem::last_write_time(source, ignored);
}

}  // namespace

std::vector<sim::JointRange> limits_for_board(const sim::RobotModel& robot) {
  std::vector<sim::JointRange> changed;
  if (robot.is_kaz()) return changed;
  std::size_t channel = 0;
  for (std::size_t j = 0; j < robot.motors(); ++j) {
    const sim::RobotJoint& joint = robot.joints[j];
    if (channel == KZ_JOINTS) {
      changed.push_back({joint.name, 0, 0});
      continue;
    }
    const double lower = std::max(joint.lower, kRadPerUnit * kz_board_joints[channel].lower);
    const double upper = std::min(joint.upper, kRadPerUnit * kz_board_joints[channel].upper);
    if (upper - lower < kMinRange) {
      changed.push_back({joint.name, 0, 0});
      continue;
    }
    const double unit = joint.pinion_m > 0 ? joint.pinion_m : 1;
    if (lower > joint.lower || upper < joint.upper)
      changed.push_back({joint.name, unit * lower, unit * upper});
    ++channel;
  }
  return changed;
}

std::string board_file_name(const std::string& urdf_path) {
  return board_file_path(urdf_path).filename().string();
}

Result<std::string> write_board_file(const std::string& urdf_path,
                                     const std::vector<sim::JointRange>& limits) {
  const auto path = board_file_path(urdf_path);
  if (limits.empty() || is_newer(path, urdf_path)) return std::string();
  KAZ_TRY(write_whole_file(path.string(), KAZ_TRY(sim::urdf_with_limits(urdf_path, limits))));
  std::string narrower, fixed;
  for (const sim::JointRange& range : limits) {
    std::string& list = range.lower >= range.upper ? fixed : narrower;
    list += (list.empty() ? "" : ", ") + range.joint;
    char text[60];
    std::snprintf(text, sizeof text, " %.3g to %.3g", range.lower, range.upper);
    if (range.lower < range.upper) list += text;
  }
  return "wrote " + board_file_name(urdf_path) + " with limits that the servo board permits: " +
         narrower + (fixed.empty() ? "" : "; fixed: " + fixed);
}

}  // namespace kaz::tools
