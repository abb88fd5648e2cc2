// The Simulation class of Python.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "python/src/python.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::python {

// A Robot in a simulation keeps the simulation alive. The Robot uses the lock of the simulation, because the
// Robot's calls advance the simulation.
class SimulatedWorld : public Locked<sim::Simulation> {
 public:
  // `links`: names of the robot's links, including welded links.
  SimulatedWorld(std::unique_ptr<sim::Simulation> simulation, std::vector<std::string> links)
      : Locked("this Simulation, or a Robot in it,", std::move(simulation)),
        links_(std::move(links)) {}
  const std::vector<std::string>& links() const { return links_; }

 private:
  const std::vector<std::string> links_;
};

}  // namespace kaz::python
