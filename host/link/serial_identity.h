// Identifies the USB adapter of a serial port, to find the adapter again after it was plugged in under
// another name.
// SPDX-License-Identifier: Apache-2.0
//
// The kernel numbers ports in the order in which adapters are plugged in. An adapter at /dev/ttyUSB0 may
// return as /dev/ttyUSB1, and another adapter may have become /dev/ttyUSB0. The identity comes from sysfs.
// /dev/serial/by-id has the same data, but exists only if udev runs.
#pragma once

#include <optional>
#include <string>

namespace kaz::host {

// Returns vendor, product, serial number and interface: "0403:6001 A50285BI.00". If the adapter has no serial
// number, the number of the USB socket replaces it: "1a86:7523 @1-1.2.00". Empty if the port does not belong
// to a USB adapter (UART, pseudo-terminal). `sys`: mount point of sysfs; tests pass another folder.
std::string serial_identity(const std::string& path, const std::string& sys = "/sys");

// Returns the current path of the adapter's port, such as "/dev/ttyUSB1"; nullopt if the adapter is not
// plugged in.
std::optional<std::string> find_serial_port(const std::string& identity,
                                            const std::string& sys = "/sys");

}  // namespace kaz::host
