// Text commands for a motor stand's tools, one command per line: the same in one process and over the control
// socket. docs/bench.md lists them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/simulation.h"
#include "sim/stand/motor_stand.h"

namespace kaz::sim {

// Board and motors on a stand. The options for robot, world, eyes and dynamics are
// ignored. Errors: those of the engine.
Result<std::unique_ptr<Simulation>> make_stand(const SimulationOptions& options,
                                               const StandOptions& stand);

// Null: the simulation is of a robot.
MotorStand* stand_of(Simulation& simulation);

// Executes `line` on the simulation's motor stand, which must exist. Errors (usage): an unknown command,
// joint or value.
Result<nlohmann::ordered_json> answer_stand(Simulation& simulation, const std::string& line);

}  // namespace kaz::sim
