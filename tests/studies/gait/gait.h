// A known gait of Kaz as a load for the dynamics: walking and turning by slip, as joint angles over phase.
// SPDX-License-Identifier: Apache-2.0
//
// It was found on another simulator of the same body: steppers are compared by what it does there. The
// pattern is the product's (host/motion/gait.h); here the trunk leans as far as a table says, and not as
// far as the product's criterion asks.
#pragma once

#include "host/motion/gait.h"

namespace kaz::gait {

using host::JointAngles;
using motion::home;
using motion::kDegree;

struct Shape {
  double period = 1.0;         // s
  double roll = 20 * kDegree;  // of the trunk to each side
  double lift = 0.010;         // m
  double swing = 0.30;         // of the cycle, each foot
  double lag = 0.02;           // of the cycle, of the feet behind the trunk
};

struct Stride {
  double left = 0, right = 0;  // m, of each foot against the hips
};

inline JointAngles stepping(const Shape& shape, double phase, const motion::Steps& steps) {
  return motion::legs_at(
      {.period = shape.period, .swing = shape.swing, .lift = shape.lift, .lag = shape.lag},
      shape.roll, phase, steps);
}

// `amplitude`: 0 stands, 1 walks in full.
inline JointAngles walking(const Shape& shape, double phase, double amplitude,
                           const Stride& stride) {
  return stepping(shape, phase,
                  {.amplitude = amplitude, .left = stride.left, .right = stride.right});
}

// `reach`: m, of each foot to and fro against the hips; > 0 turns left, twice a cycle, while both feet
// carry. At phase shape.lag and half a cycle later the feet pass the hips: there it may change.
inline JointAngles turning(const Shape& shape, double phase, double amplitude, double reach) {
  return stepping(shape, phase, {.amplitude = amplitude, .reach = reach});
}

}  // namespace kaz::gait
