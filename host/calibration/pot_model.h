// A potentiometer as a calibration models it: nominal line, offset, and deviation from the line.
// SPDX-License-Identifier: Apache-2.0
//
// With u = 2 (code + 1/2) / 1024 - 1, from -1 to 1 over the track (the converter rounds down, so a code
// stands for its middle), the joint's angle is
//   angle(code) = nominal(code) + p0 + p1 u + (1 - u^2) (p2 + p3 a u + p4 b (9 u^2 - 1))
// p0 is the mounting offset, p1 the tolerance of the track's length. The rest is the element's linearity
// error, which makers state between the terminals, where it is zero; its terms are the lowest polynomials
// that vanish at both ends, a and b make each term's largest value 1. rad.
#pragma once

#include <array>

#include "host/robot/robot_types.h"
#include "shared/base/angle.hpp"

namespace kaz::calibration {

inline constexpr int kPotTerms = 5;

// What is known of a potentiometer before anything is measured: one standard deviation of each term. A
// mounting error is at most 1 degree, the track's length is right within 1 %, a linearity error at most 0.5 %
// of the range (0.95 degrees), which is taken for three standard deviations of the sum of its terms. Slow
// deviations are larger than fast ones (shared/robot/kaz/sensors.xml).
inline constexpr std::array<double, kPotTerms> kPotPrior{
    0.6 * kDegree, 0.3 * kDegree, 0.27 * kDegree, 0.14 * kDegree, 0.07 * kDegree};
// A reading further from the nominal line is no mounting or linearity error.
inline constexpr double kMaxPotError = 2.5 * kDegree;

// The calibration of a board that has none.
host::JointCalibration nominal_calibration(int joint);
double angle_at(const host::JointCalibration& line, double code);
double code_at(const host::JointCalibration& line, double angle_rad);
// Of the terms p0..p4 at a code, which may be a mean and need not be whole.
std::array<double, kPotTerms> pot_terms(double code);

// Where a joint's mechanical stops are: 1 degree outside of its limits (docs/reference/robot.md).
inline constexpr double kBeyondLimit = 1 * kDegree;
enum class Stop { lower, upper };
double stop_angle(int joint, Stop stop);

}  // namespace kaz::calibration
