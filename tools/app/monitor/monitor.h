// `kaz monitor`: displays joints, supply, tick and link in a terminal, and moves joints by keys.
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
  // For parse_port_address() or parse_bus().
  std::string port;
  std::string robot_file;  // URDF; Kaz if empty. A servo bus requires one.
  std::uint8_t address = KZ_ADDRESS_DEFAULT;
  sim::MessageTap* tap = nullptr;  // receives the messages on the line; must outlive the call
  std::string watched_at;          // address of the viewer for the first line; empty: none
};

// Runs until q or Ctrl-C. If it switched motors on, it switches them off at the end and restores the link
// watchdog. Fails (usage or environment) without a terminal, or without a board at the port.
Result<bool> monitor(const MonitorOptions& options);

}  // namespace kaz::tools
