// Computes the joint angles of a robot that walks on the spot. Benchmarks use this motion as their workload.
// SPDX-License-Identifier: Apache-2.0
//
// The trunk rolls about the hips. Each foot swings for 0.3 of a cycle and is lifted by 10 mm. The hips are
// 0.145 m above the soles. The trunk leans forward by 3 degrees. Shank and thigh are 65 mm long.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/base/angle.hpp"
#include "shared/board/board.h"

namespace kaz::sim::bench {

using Angles = std::array<double, KZ_JOINTS>;  // rad, indexed by the joint numbers of joints.def

// Returns the joint angles at the time `phase`, in cycles. A cycle takes 1 s. `walk` scales the motion: with
// 0, the robot stands in the crouch for walking; with 1, the robot lifts the feet to the full height.
inline Angles walking_angles(double walk, double phase) {
  constexpr double kBone = 0.065, kHipHeight = 0.145, kAnkleHeight = 0.030;
  constexpr double kLean = 3 * kDegree, kRoll = 16 * kDegree, kLift = 0.010, kHipSide = 0.033;
  constexpr double kSwing = 0.30, kLag = 0.02;  // fractions of a cycle
  constexpr int kLeftHipRoll = 10, kRightHipRoll = 14;
  Angles angles{};
  for (const int shoulder : {2, 6}) {
    angles[static_cast<std::size_t>(shoulder)] = 10 * kDegree;
    angles[static_cast<std::size_t>(shoulder + 1)] = (shoulder == 2 ? 12 : -12) * kDegree;
    angles[static_cast<std::size_t>(shoulder + 2)] = -40 * kDegree;
  }
  const double roll = -walk * kRoll * std::sin(2 * M_PI * phase);
  for (const bool left : {true, false}) {
    const double from = phase - kLag - (left ? 0.75 : 0.25) + kSwing / 2;
    const double into = (from - std::floor(from)) / kSwing;
    const double lift = into < 1 ? walk * kLift * (1 - std::cos(2 * M_PI * into)) / 2 : 0;
    const double up = (left ? kHipSide : -kHipSide) * std::sin(roll);
    const double forward = -up * std::sin(kLean);  // position of the ankle relative to the hip
    const double down = kHipHeight + up * std::cos(kLean) - lift - kAnkleHeight;
    const double leg = std::min(std::hypot(forward, down), 2 * kBone);
    const double knee = std::acos(leg * leg / (2 * kBone * kBone) - 1);
    const double thigh = std::atan2(-forward, down) - std::asin(kBone * std::sin(knee) / leg);
    double* const out = angles.data() + (left ? kLeftHipRoll : kRightHipRoll);
    out[0] = -roll;
    out[1] = thigh - kLean;
    out[2] = knee;
    out[3] = -(thigh + knee);
  }
  return angles;
}

}  // namespace kaz::sim::bench
