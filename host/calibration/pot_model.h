// Calibration model of a potentiometer: nominal line, offset, and deviation from the line.
// SPDX-License-Identifier: Apache-2.0
//
// Let u = 2 (code + 1/2) / 1024 - 1, from -1 to 1 over the track. The converter rounds down. So each code is
// assigned to the middle of its interval. This formula gives the joint's angle in rad:
//   angle(code) = nominal(code) + p0 + p1 u + (1 - u^2) (p2 + p3 a u + p4 b (9 u^2 - 1)).
// In this formula, p0 is the mounting offset, and p1 is the tolerance of the track's length. The other terms
// are the linearity error of the resistive element. By the manufacturers' definition, the linearity error is
// zero at both terminals. So these terms are the polynomials of lowest degree that vanish at both ends. The
// constants `a` and `b` scale the polynomials of p3 and p4 to a maximum of 1.
#pragma once

#include <array>

#include "host/robot/robot_types.h"
#include "shared/base/angle.hpp"

namespace kaz::calibration {

inline constexpr int kPotTerms = 5;

// Prior standard deviation of each term, rad. A mounting error is at most 1 degree, and the error of the
// track's length is at most 1 %. A linearity error is at most 0.5 % of the range (0.95 degrees). The standard
// deviation of the sum of all linearity terms is a third of the maximum linearity error. Linearity errors
// that change slowly along the track are larger than those that change fast (shared/robot/kaz/sensors.xml).
inline constexpr std::array<double, kPotTerms> kPotPrior{
    0.6 * kDegree, 0.3 * kDegree, 0.27 * kDegree, 0.14 * kDegree, 0.07 * kDegree};
// Largest distance of a reading from the nominal line that mounting and linearity errors can explain, rad.
inline constexpr double kMaxPotError = 2.5 * kDegree;

// Returns the line that a board without a calibration uses.
host::JointCalibration nominal_calibration(int joint);
// Conversion from a code to the angle (rad) on a calibration line, and from an angle to the code.
double angle_at(const host::JointCalibration& line, double code);
double code_at(const host::JointCalibration& line, double angle_rad);
// Returns the derivatives of the angle with respect to p0..p4 at `code`. The code may be a mean, so it need
// not be whole.
std::array<double, kPotTerms> pot_terms(double code);

// Distance of a joint's mechanical stops from its limits, rad (docs/reference/robot.md).
inline constexpr double kBeyondLimit = 1 * kDegree;
enum class Stop { lower, upper };
double stop_angle(int joint, Stop stop);

}  // namespace kaz::calibration
