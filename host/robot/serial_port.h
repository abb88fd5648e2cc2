// Opening a serial port: raw 8N1, ours alone, as quick as the adapter can be.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::host {

// Device paths at which a board may sit: USB serial adapters and UARTs that exist, sorted.
std::vector<std::string> serial_port_candidates();

// Opens `path` non-blocking, 8 data bits, no parity, 1 stop bit, no flow control, no echo, no
// translation. `path` may be a pseudo-terminal or a symbolic link to one. Returns the file
// descriptor, which the caller closes. Errors, each one sentence: no such port (lists the
// candidates), permission (names the group), in use by another program, no terminal, unsupported
// `baud` (Fault::usage).
Result<int> open_serial_port(const std::string& path, int baud);

}  // namespace kaz::host
