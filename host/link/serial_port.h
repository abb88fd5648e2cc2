// Opens serial ports: raw mode, 8N1, for exclusive use, with the lowest latency of the adapter.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::host {

// Returns the sorted device paths of existing USB serial adapters and UARTs, to which a board may be
// connected.
std::vector<std::string> serial_port_candidates();

// Whether the adapter's driver delivers received bytes without delay. For links other than serial ports, the
// value is `bus` (CAN) or `network` (TCP).
enum class LowLatency { set, refused, pseudo_terminal, bus, network };
struct OpenPort {
  int descriptor = -1;  // the caller must close the descriptor
  LowLatency low_latency = LowLatency::refused;
};

// Opens `path` non-blocking with 8 data bits, no parity, 1 stop bit, no flow control, no echo and no
// translation. `path` may also be a pseudo-terminal or a symbolic link to a port. Requests low latency from
// the driver; the drivers of FTDI adapters support this mode. Fails (environment) if the port is missing, not
// permitted, in use, not a terminal, or left behind by a killed simulator. The message contains the remedy.
// Fails (usage) for an unsupported `baud`.
Result<OpenPort> open_serial_port(const std::string& path, int baud);

// Sets the rate of an open port. `path` appears in error messages. Fails (usage) if this system does not
// support the rate.
Result<void> set_serial_rate(int descriptor, const std::string& path, int baud);

// Returns the group with read and write access to a device; empty if no group except root's has access.
std::string group_with_access(const std::string& path);

// Returns the error message for a port that the user may not open. If `group` (from group_with_access()) is
// not empty, the message suggests that the user joins this group. If `group` is empty, but `vendor` and
// `product` are not empty, the message suggests a udev rule for the USB adapter. If `group` and at least one
// of `vendor` and `product` are empty, the message suggests chgrp and chmod. `vendor` and `product` are
// hexadecimal USB numbers, as in sysfs.
std::string permission_sentence(const std::string& path, const std::string& vendor,
                                const std::string& product, const std::string& group);

}  // namespace kaz::host
