// The robot that a run controls, as selected by --robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "host/link/port_address.h"
#include "shared/base/result.hpp"
#include "shared/servo_bus/registers.h"
#include "tools/run/backend_options.h"
#include "tools/run/board_file.h"

namespace kaz::tools {

struct SimulatedTarget {};
struct PortTarget {
  host::PortAddress port;
  std::uint8_t address = 1;
};
struct BoardsTarget {
  std::string file;
  std::vector<BoardOfFile> boards;
};
struct BusTarget {
  servo_bus::Protocol protocol = servo_bus::Protocol::feetech;
  host::PortAddress port;  // baud 0: the rate in bus.json
};
using Target = std::variant<SimulatedTarget, PortTarget, BoardsTarget, BusTarget>;

// Parses `options.robot`, and reads the file of boards:FILE. Fails (usage) for unknown kinds of robots, and
// for options that are not valid with the robot.
Result<Target> target_of(const BackendOptions& options);

}  // namespace kaz::tools
