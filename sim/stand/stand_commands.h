// Text commands for the tools of a motor stand, one per line, for use in process or over the control socket.
// docs/howto/bench.md lists them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"
#include "sim/stand/motor_stand.h"

namespace kaz::sim {

// Creates a simulation of board and motors on a stand. Options of robot, world, eyes and dynamics are
// ignored; supply_ohms is that of a laboratory supply. Errors: those of make_mcu().
Result<std::unique_ptr<Simulation>> make_stand(const SimulationOptions& options,
                                               const StandOptions& stand);

// Returns the stand of a simulation, null if it simulates a robot.
MotorStand* stand_of(Simulation& simulation);

// Executes the command `line` on the simulation's motor stand. Precondition: stand_of() is not null. Errors
// (usage): an unknown command, joint or value.
Result<nlohmann::ordered_json> answer_stand(Simulation& simulation, const std::string& line);

}  // namespace kaz::sim
