// `kaz monitor`: joints, supply, tick and link in a terminal, and keys to move the joints.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "shared/base/result.hpp"
#include "shared/protocol/messages.h"

namespace kaz::sim {
class MessageTap;
}

namespace kaz::tools {

struct MonitorOptions {
  // As parse_port_address() has it, or feetech:PATH[@BAUD], dynamixel:PATH[@BAUD].
  std::string port;
  std::string robot_file;  // URDF; Kaz if empty, and a bus of servos needs one
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  sim::MessageTap* tap = nullptr;  // hears what passes on the line; must outlive the call
  std::string watched_at;          // where to look, as the first line says; empty: nowhere
};

// Runs until q or Ctrl-C. A board whose motors were switched on here has its watchdog back afterwards.
// Errors: usage, no terminal, no board at the port.
Result<bool> monitor(const MonitorOptions& options);

}  // namespace kaz::tools
