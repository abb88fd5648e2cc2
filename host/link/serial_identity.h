// Which USB adapter a serial port belongs to: finds it again under another name after it was plugged in anew.
// SPDX-License-Identifier: Apache-2.0
//
// The kernel numbers ports as they come: what was /dev/ttyUSB0 may return as /dev/ttyUSB1, and another
// adapter may be /dev/ttyUSB0 by then. Read from sysfs and not from /dev/serial/by-id, whose names say
// the same but exist only where udev runs.
#pragma once

#include <optional>
#include <string>

namespace kaz::host {

// "0403:6001 A50285BI.00": vendor, product, serial number, interface. An adapter without a serial number has
// the USB socket that it is plugged into instead: "1a86:7523 @1-1.2.00". Empty for what is no USB adapter: a
// UART, a pseudo-terminal. `sys` is another folder in tests.
std::string serial_identity(const std::string& path, const std::string& sys = "/sys");

// The path of the port that has it now, "/dev/ttyUSB1"; nothing if it is not plugged in.
std::optional<std::string> find_serial_port(const std::string& identity,
                                            const std::string& sys = "/sys");

}  // namespace kaz::host
