// Engines that simulate a toss, and their contact parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "tests/studies/contact/toss.h"

namespace kaz::contact {

inline constexpr double kCubeMass = 0.37;        // kg
inline constexpr double kCubeInertia = 0.00081;  // kg m2, about each axis

// A contact parameter to fit.
struct Parameter {
  std::string name, unit;
  double low = 0, high = 1, start = 0.5;
  bool logarithmic = false;  // searched by its logarithm; low must be above 0

  double value_at(double share) const;  // value at a share 0..1 of the range
  double share_of(double value) const;  // inverse of value_at()
};

struct Engine {
  std::string name;
  std::vector<Parameter> parameters;
  // Simulates a toss from its first sample with a value for each parameter, and returns as many poses as the
  // toss has samples. Thread-safe. If the physics breaks down, the path's later poses do not move. Returns an
  // error if the engine cannot be created.
  std::function<Result<Path>(const Toss& toss, std::span<const double> values)> simulate;

  std::vector<double> start() const;  // start value of each parameter
};

// Names of all engines, in the order of the table's rows.
std::vector<std::string> engine_names();

// Returns an engine: `reduced`, `exact` or `quickN` (WorldOptions::dynamics), or `mujoco`. `steps`: number of
// steps in a sample of 1/148 s. Returns Fault::usage for an unknown name, Fault::environment if libmujoco is
// missing.
Result<Engine> engine_of(const std::string& name, int steps);

// The same for the engines of Kaz only (kaz_engine.cpp) and for MuJoCo only (mujoco_engine.cpp).
Result<Engine> kaz_engine(const std::string& dynamics, int steps);
Result<Engine> mujoco_engine(int steps);

}  // namespace kaz::contact
