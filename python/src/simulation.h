// Simulation as Python has it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "python/src/python.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::python {

// Whoever has it keeps it alive: a Robot in it outlives the variable that it was made of.
class SimulatedWorld {
 public:
  // `links`: names of the robot's links, the welded ones included.
  SimulatedWorld(std::unique_ptr<sim::Simulation> simulation, std::vector<std::string> links)
      : simulation_(std::move(simulation)), links_(std::move(links)) {}
  sim::Simulation& simulation() { return *simulation_; }
  const std::vector<std::string>& links() const { return links_; }

 private:
  std::unique_ptr<sim::Simulation> simulation_;
  std::vector<std::string> links_;
};

}  // namespace kaz::python
