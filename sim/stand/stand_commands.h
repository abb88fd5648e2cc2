// Text commands for the tools of a motor stand, one per line. The commands are used within the process or
// over the control socket. docs/howto/bench.md lists the commands.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"
#include "sim/stand/motor_stand.h"

namespace kaz::sim {

// Creates a simulation of a board with motors on a stand. The options of robot, world, eyes and dynamics are
// ignored; supply_ohms is set to the resistance of a laboratory supply. Returns the errors of make_mcu().
Result<std::unique_ptr<Simulation>> make_stand(const SimulationOptions& options,
                                               const StandOptions& stand);

// Returns the stand of a simulation, or null if the simulation has a robot instead of a stand.
MotorStand* stand_of(Simulation& simulation);

// Executes the command `line` on the simulation's motor stand. Precondition: stand_of() is not null. Returns
// Fault::usage if the command, the joint or a value is invalid.
Result<nlohmann::ordered_json> answer_stand(Simulation& simulation, const std::string& line);

}  // namespace kaz::sim
