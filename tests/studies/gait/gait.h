// A known gait of Kaz as a load for the dynamics: joint angles over phase, for walking and for turning by
// slip.
// SPDX-License-Identifier: Apache-2.0
//
// It was found in another simulator of the same body, whose results are the reference for each dynamics. The
// pattern is the product's (host/motion/gait.h). But the trunk's roll is a parameter here, not computed from
// the product's stability criterion.
#pragma once

#include "host/motion/gait.h"
#include "shared/base/angle.hpp"

namespace kaz::gait {

using host::JointAngles;
using motion::home;

struct Shape {
  double period = 1.0;         // s
  double roll = 20 * kDegree;  // roll of the trunk to each side
  double lift = 0.010;         // m
  double swing = 0.30;         // share of the cycle in which each foot swings
  double lag = 0.02;           // share of the cycle by which the feet follow the trunk
};

struct Stride {
  double left = 0, right = 0;  // m, stroke of each foot relative to the hips
};

inline JointAngles stepping(const Shape& shape, double phase, const motion::Steps& steps) {
  return motion::legs_at(
      {.period = shape.period, .swing = shape.swing, .lift = shape.lift, .lag = shape.lag},
      shape.roll, phase, steps);
}

// Returns the joint angles of walking. `amplitude`: 0 stands, 1 is the full gait.
inline JointAngles walking(const Shape& shape, double phase, double amplitude,
                           const Stride& stride) {
  return stepping(shape, phase,
                  {.amplitude = amplitude, .left = stride.left, .right = stride.right});
}

// Returns the joint angles of turning in both double-support phases of a cycle. `reach`: forward and backward
// stroke of the feet relative to the hips, m; > 0 turns left. It may change at phase shape.lag and half a
// cycle later, when the feet pass the hips.
inline JointAngles turning(const Shape& shape, double phase, double amplitude, double reach) {
  return stepping(shape, phase, {.amplitude = amplitude, .reach = reach});
}

}  // namespace kaz::gait
