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

// A calibration is good if the expected error (two standard deviations) is below this limit at 95 % of the
// angles. The limit for a gauge is larger: a gauge gives only a few angles, so it determines slope and curve
// of a potentiometer less well.
inline constexpr double kGoodError = 0.5 * kDegree, kGoodByGauge = 1 * kDegree;

struct GaugeReading {
  int joint = 0;
  double code = 0, angle_rad = 0;
};

struct JointReport {
  // `port`: "sim", or a path such as "/dev/ttyUSB0". `board`: identification that the board reported.
  std::string port, board;
  bool stops = false, floor = false, gauge = false;  // whether each method was requested
  std::uint32_t joints = 0;                          // mask of the joints to calibrate
  std::vector<calibration::StopReading> stop_readings;
  std::vector<calibration::FloorReading> floor_readings;
  std::vector<GaugeReading> gauge_readings;
  double gauge_error_rad = 0;  // standard deviation of an angle at the gauge
  std::array<host::JointCalibration, KZ_JOINTS> before{};
  std::optional<calibration::JointEstimator::Solution> solution;
  std::optional<host::StoredCalibration> stored;
  std::optional<Error> error;  // error that ended the measurements early, if any
  std::string signal;          // name of the signal that ended the measurements early
  double seconds = 0;          // duration of the measurements in robot time
};

// Returns one sentence that states what is wrong with a joint's calibration. Returns "" if the calibration is
// good, or if the calibration was not requested.
std::string fault_of(const JointReport& report, int joint);
// Returns the joints for which fault_of() is not empty. If floor readings contradict each other, every joint
// of the legs has a fault.
std::vector<int> faulty(const JointReport& report);

std::string joint_table_text(const JointReport& report);
nlohmann::ordered_json joint_report_json(const JointReport& report);
// Returns a picture with one row per joint. The bars show the 95th percentile of the joint's expected error
// over its range, and the largest expected error.
std::string joint_report_svg(const JointReport& report);

}  // namespace kaz::tools
