// Identifies the USB adapter of a serial port, to find it under a new name after it was plugged in again.
// SPDX-License-Identifier: Apache-2.0
//
// The kernel numbers ports in order of arrival. An adapter at /dev/ttyUSB0 may return as /dev/ttyUSB1, while
// another has become /dev/ttyUSB0. The identity comes from sysfs. /dev/serial/by-id has the same data, but
// only where udev runs.
#pragma once

#include <optional>
#include <string>

namespace kaz::host {

// Vendor, product, serial number and interface: "0403:6001 A50285BI.00". Without a serial number, the USB
// socket takes its place: "1a86:7523 @1-1.2.00". Empty if the port is not on a USB adapter (UART,
// pseudo-terminal). Tests pass another folder for `sys`.
std::string serial_identity(const std::string& path, const std::string& sys = "/sys");

// Current path of the adapter's port, such as "/dev/ttyUSB1"; nullopt if it is not plugged in.
std::optional<std::string> find_serial_port(const std::string& identity,
                                            const std::string& sys = "/sys");

}  // namespace kaz::host
