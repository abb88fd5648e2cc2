// Parameters and names of the engines.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/contact/engine.h"

#include <algorithm>
#include <cmath>

namespace kaz::contact {

double Parameter::value_at(double share) const {
  return logarithmic ? low * std::pow(high / low, share) : low + share * (high - low);
}

double Parameter::share_of(double value) const {
  return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

std::vector<double> Engine::start() const {
  std::vector<double> values;
  for (const Parameter& one : parameters) values.push_back(one.start);
  return values;
}

std::vector<std::string> engine_names() {
  return {"reduced", "exact", "quick50", "mujoco"};
}

Result<Engine> engine_of(const std::string& name, int steps) {
  if (name == "mujoco") return mujoco_engine(steps);
  return kaz_engine(name, steps);
}

}  // namespace kaz::contact
