// Report of `kaz calibrate joints`: table, JSON, picture.
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

// A joint is well calibrated if 95 % of its angles are expected to err by less: two standard deviations. By a
// gauge, which gives one angle or a few, the potentiometer's slope and curve are not known better than this.
inline constexpr double kGoodError = 0.5 * kDegree, kGoodByGauge = 1 * kDegree;

struct GaugeReading {
  int joint = 0;
  double code = 0, angle_rad = 0;
};

struct JointReport {
  std::string port, board;  // "sim", "/dev/ttyUSB0"; what it says of itself
  bool stops = false, floor = false, gauge = false;  // what was to be read
  std::uint32_t joints = 0;                          // which were to be calibrated
  std::vector<calibration::StopReading> stop_readings;
  std::vector<calibration::FloorReading> floor_readings;
  std::vector<GaugeReading> gauge_readings;
  double gauge_error_rad = 0;  // one standard deviation of such an angle
  std::array<host::JointCalibration, KZ_JOINTS> before{};
  std::optional<calibration::JointEstimator::Solution> solution;
  std::optional<host::StoredCalibration> stored;
  std::optional<Error> error;  // what ended the measurements early
  std::string signal;          // that was it; its name
  double seconds = 0;          // of the robot
};

// What is wrong with a joint's calibration, one sentence; empty if nothing is, or it was not to be
// calibrated.
std::string fault_of(const JointReport& report, int joint);
// Joints with a fault; of floor readings that contradict each other, all joints of the legs.
std::vector<int> faulty(const JointReport& report);

std::string joint_table_text(const JointReport& report);
nlohmann::ordered_json joint_report_json(const JointReport& report);
// A bar for each joint: expected error over its range, and where it is largest.
std::string joint_report_svg(const JointReport& report);

}  // namespace kaz::tools
