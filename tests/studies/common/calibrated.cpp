// The error of a joint's calibration by ground truth.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/common/calibrated.h"

#include "host/calibration/joint_readings.h"
#include "sim/board/potentiometer.h"

namespace kaz::studies {

std::vector<double> true_errors(const sim::SensorParams& params, sim::SensorSet sensors,
                                std::uint64_t seed, int joint, const host::JointCalibration& line,
                                int count) {
  const sim::Potentiometer pot(joint, params.potentiometer, sim::sensor_switches(sensors), seed);
  const auto& info = host::joint_table()[static_cast<std::size_t>(joint)];
  std::vector<double> errors;
  for (int i = 0; i < count; ++i) {
    const double angle = info.lower_rad + (info.upper_rad - info.lower_rad) * i / (count - 1);
    // Noise and rounding down: a mean code is half a code below the input.
    const double code = pot.ratio(angle) * KZ_POT_CODES - 0.5;
    errors.push_back(calibration::angle_at(line, code) - angle);
  }
  return errors;
}

}  // namespace kaz::studies
