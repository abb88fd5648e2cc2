// A motor stand's tools by words, one command a line: the same in one process and over the control
// socket. docs/howto/bench.md lists them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/simulation/simulation.h"
#include "sim/stand/motor_stand.h"

namespace kaz::sim {

// Board and motors on a stand. Of the options, those of robot, world, eyes and dynamics do not
// count. Errors: those of make_mcu().
Result<std::unique_ptr<Simulation>> make_stand(const SimulationOptions& options,
                                               const StandOptions& stand);

// Null: it is a robot's.
MotorStand* stand_of(Simulation& simulation);

// Executes the command `line` on the simulation's motor stand, which must exist. Errors (usage): an unknown
// command, joint or value.
Result<nlohmann::ordered_json> answer_stand(Simulation& simulation, const std::string& line);

}  // namespace kaz::sim
