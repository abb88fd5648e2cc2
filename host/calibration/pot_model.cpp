// A potentiometer as a calibration models it.
// SPDX-License-Identifier: Apache-2.0
#include "host/calibration/pot_model.h"

#include "shared/board/table.h"

namespace kaz::calibration {

namespace {

constexpr double kHalfCodes = KZ_POT_CODES / 2;

}  // namespace

host::JointCalibration nominal_calibration(int joint) {
  const kz_board_joint& board = kz_board_joints[joint];
  return {static_cast<double>(board.pot_centre) / KZ_ANGLE_PER_RAD,
          static_cast<double>(board.pot_scale) / KZ_ANGLE_PER_RAD};
}

double angle_at(const host::JointCalibration& line, double code) {
  return line.centre_rad + line.scale_rad * (code - kHalfCodes) / kHalfCodes;
}

double code_at(const host::JointCalibration& line, double angle_rad) {
  return kHalfCodes + kHalfCodes * (angle_rad - line.centre_rad) / line.scale_rad;
}

std::array<double, kPotTerms> pot_terms(double code) {
  const double u = (code + 0.5) / kHalfCodes - 1;
  const double bow = 1 - u * u;
  // Largest values of (1 - u^2) u and of (1 - u^2) (9 u^2 - 1): 2 / 3^1.5 and 16 / 9.
  return {1, u, bow, bow * u * 2.598076, bow * (9 * u * u - 1) * 0.5625};
}

double stop_angle(int joint, Stop stop) {
  const host::JointInfo& info = host::joint_table()[static_cast<std::size_t>(joint)];
  return stop == Stop::lower ? info.lower_rad - kBeyondLimit : info.upper_rad + kBeyondLimit;
}

}  // namespace kaz::calibration
