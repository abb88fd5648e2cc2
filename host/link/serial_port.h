// Opening a serial port: raw 8N1, ours alone, as quick as the adapter can be.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::host {

// Device paths at which a board may sit: USB serial adapters and UARTs that exist, sorted.
std::vector<std::string> serial_port_candidates();

// Whether the adapter's driver hands received bytes over at once; `bus` and `network` are no serial ports.
enum class LowLatency { set, refused, pseudo_terminal, bus, network };
struct OpenPort {
  int descriptor = -1;  // the caller closes it
  LowLatency low_latency = LowLatency::refused;
};

// Opens `path` non-blocking, 8 data bits, no parity, 1 stop bit, no flow control, no echo, no
// translation. `path` may be a pseudo-terminal or a symbolic link to one. Asks the driver for low
// latency, which FTDI adapters take. Errors, each one sentence: no such port (lists the candidates),
// permission (names the group and a udev rule), in use by another program, no terminal, left behind by a
// simulator that was killed, unsupported `baud` (Fault::usage).
Result<OpenPort> open_serial_port(const std::string& path, int baud);

// Another rate for a port that is open. Errors: Fault::usage for a rate that no port has here.
Result<void> set_serial_rate(int descriptor, const std::string& path, int baud);

// The group whose members may read and write a device; empty: none, or root's.
std::string group_with_access(const std::string& path);

// The sentence for a port that we may not open: what to do once, or for good with a rule for the
// adapter. Numbers in hexadecimal, as sysfs has them; empty if it is no USB adapter. `group`: that of
// group_with_access().
std::string permission_sentence(const std::string& path, const std::string& vendor,
                                const std::string& product, const std::string& group);

}  // namespace kaz::host
