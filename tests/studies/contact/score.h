// The published score of a toss, and intervals by bootstrap.
// SPDX-License-Identifier: Apache-2.0
//
// Source: Acosta, Yang and Posa 2022, "Validating Robotics Simulators on Real-World Impacts".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tests/studies/contact/toss.h"

namespace kaz::contact {

// Returns |dx|^2 + theta^2: distance of the centers in half edges, and angle (rad, 0 to pi) of the rotation
// between the orientations.
double pose_error(const Pose& a, const Pose& b);

// Returns the mean pose_error() over all samples, including the first one. The paths must be equally long.
double path_error(const Path& measured, const Path& simulated);

struct Interval {
  double low = 0, high = 0;
};

double mean(std::span<const double> values);    // 0 without values
double median(std::span<const double> values);  // 0 without values

// Returns the 95 % interval of the mean: percentiles of 10,000 samples with replacement.
Interval bootstrap_mean(std::span<const double> values, std::uint64_t seed);
// Returns the 95 % interval of mean(a) / mean(b), with the same tosses in both means of a sample. `a` and `b`
// are equally long.
Interval bootstrap_ratio(std::span<const double> a, std::span<const double> b, std::uint64_t seed);

}  // namespace kaz::contact
