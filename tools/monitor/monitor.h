// `kaz monitor`: displays joints, supply, tick and link in a terminal. The user can move joints with keys.
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
  // Port of the board, as for parse_port_address(), or a servo bus, as for parse_bus().
  std::string port;
  std::string robot_file;  // URDF file of the robot; empty: Kaz; must not be empty for a servo bus
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  sim::MessageTap* tap = nullptr;  // receives the messages on the line; must outlive the call
  // Address of the viewer's page, displayed in the first line; empty: no viewer.
  std::string watched_at;
};

// Runs until q or Ctrl-C. If a key has switched motors on, monitor() switches the motors off at the end and
// restores the settings of the link watchdog. Fails (usage or environment) if there is no terminal, or no
// board at the port.
Result<bool> monitor(const MonitorOptions& options);

}  // namespace kaz::tools
