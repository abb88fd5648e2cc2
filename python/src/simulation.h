// Simulation as Python has it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "python/src/python.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::python {

// Whoever has it keeps it alive: a Robot in it outlives the variable that it was made of.
class SimulatedWorld {
 public:
  explicit SimulatedWorld(std::unique_ptr<sim::Simulation> simulation)
      : simulation_(std::move(simulation)) {}
  sim::Simulation& simulation() { return *simulation_; }

 private:
  std::unique_ptr<sim::Simulation> simulation_;
};

}  // namespace kaz::python
