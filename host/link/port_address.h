// Parser of board addresses in --robot KIND:PATH.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/base/result.hpp"
#include "shared/board/board.h"

namespace kaz::host {

enum class PortKind {
  serial,   // serial:PATH[@BAUD]: an adapter, UART or pseudo-terminal
  can,      // can:INTERFACE: SocketCAN, frames over ISO-TP
  tcp,      // tcp:HOST:PORT: raw bytes
  rfc2217,  // rfc2217:HOST:PORT[@BAUD]: a serial port on another machine
};

struct PortAddress {
  PortKind kind = PortKind::serial;
  std::string place;           // path, interface or host
  std::uint16_t tcp_port = 0;  // for tcp and rfc2217
  int baud = KZ_BAUD;          // for serial and rfc2217

  // Name for messages: "/dev/ttyUSB0", "can:can0", "tcp:bench:7000". parse_port_address() accepts this name
  // and returns the same port. The bit rate is part of the name only if the path contains '@'.
  std::string name() const;
};

// Parses a board address. A text without one of the four prefixes is a path. IPv6 addresses need brackets:
// tcp:[::1]:7000. Errors (usage): the text is not valid. The message contains `option`, the text, the reason,
// and the accepted forms.
Result<PortAddress> parse_port_address(const std::string& option, std::string_view text);
// Returns whether the text starts with one of the four prefixes. A text without such a prefix can be a path,
// even if the text contains a colon.
bool names_port_kind(std::string_view text);
// Returns the command-line option that selects a port. Messages that suggest a command contain this option.
// For the name "/dev/ttyUSB0", the option is "--robot serial:/dev/ttyUSB0".
std::string robot_option(std::string_view port_name);

}  // namespace kaz::host
