// Report of `kaz calibrate joints`: table, JSON and picture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/calibration/joint_readings.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

// A calibration is good if 95 % of the angles have a smaller expected error (two standard deviations). A
// gauge gives only a few angles, so it determines slope and curve of a potentiometer less well.
inline constexpr double kGoodError = 0.5 * kDegree, kGoodByGauge = 1 * kDegree;

struct GaugeReading {
  int joint = 0;
  double code = 0, angle_rad = 0;
};

struct JointReport {
  std::string port, board;  // port: "sim", "/dev/ttyUSB0"; board: its own identification
  bool stops = false, floor = false, gauge = false;  // methods that were requested
  std::uint32_t joints = 0;                          // mask of the joints to calibrate
  std::vector<calibration::StopReading> stop_readings;
  std::vector<calibration::FloorReading> floor_readings;
  std::vector<GaugeReading> gauge_readings;
  double gauge_error_rad = 0;  // one standard deviation of an angle by gauge
  std::array<host::JointCalibration, KZ_JOINTS> before{};
  std::optional<calibration::JointEstimator::Solution> solution;
  std::optional<host::StoredCalibration> stored;
  std::optional<Error> error;  // error that ended the measurements early
  std::string signal;          // name of the signal that ended them
  double seconds = 0;          // robot time
};

// Returns one sentence on the fault of a joint's calibration; empty if it is good, or was not requested.
std::string fault_of(const JointReport& report, int joint);
// Returns the joints with a fault. If floor readings contradict each other, these are all joints of the legs.
std::vector<int> faulty(const JointReport& report);

std::string joint_table_text(const JointReport& report);
nlohmann::ordered_json joint_report_json(const JointReport& report);
// Returns a picture with a bar for each joint: its expected error over its range, and the largest error.
std::string joint_report_svg(const JointReport& report);

}  // namespace kaz::tools
