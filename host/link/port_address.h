// The one reader of --robot KIND:PATH for boards: where a board is.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "shared/base/result.hpp"
#include "shared/board/board.h"

namespace kaz::host {

enum class PortKind {
  serial,   // serial:PATH[@BAUD]: an adapter, a UART, a pseudo-terminal
  can,      // can:INTERFACE: SocketCAN, frames over ISO-TP
  tcp,      // tcp:HOST:PORT: bytes as they are
  rfc2217,  // rfc2217:HOST:PORT[@BAUD]: a serial port on another machine
};

struct PortAddress {
  PortKind kind = PortKind::serial;
  std::string place;           // path, interface or host
  std::uint16_t tcp_port = 0;  // of tcp and rfc2217
  int baud = KZ_BAUD;          // of serial and rfc2217

  // For messages, without the rate: "/dev/ttyUSB0", "can:can0", "tcp:bench:7000".
  // parse_port_address() accepts it.
  std::string name() const;
};

// A word without one of the four prefixes is a path. IPv6 addresses are in brackets: tcp:[::1]:7000. Errors
// (usage): `option`, the text, what is wrong with it, and the forms that it can have.
Result<PortAddress> parse_port_address(const std::string& option, std::string_view text);
// Whether the text begins as one of the four kinds; a path may contain any other colon.
bool names_port_kind(std::string_view text);
// "--robot serial:/dev/ttyUSB0" for the name() "/dev/ttyUSB0": for commands that a message suggests.
std::string robot_option(std::string_view port_name);

}  // namespace kaz::host
