// Parses values of command-line options: ports, settings, intervals, shards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/link/port_address.h"
#include "shared/base/result.hpp"
#include "shared/servo_bus/bus_file.h"
#include "tools/trials/statistics.h"

namespace kaz::tools {

// Functions that return a Result fail with Fault::usage if the text is not valid. The message contains the
// option's name and an example.

// Parses --robot of a command for servo boards (host/link/port_address.h). A path without a prefix means
// serial:PATH. Rejects the port of a servo bus.
Result<host::PortAddress> parse_port(const std::string& text);

struct BusAddress {
  // Servo protocol; empty if the text contains only a port.
  std::optional<servo_bus::Protocol> protocol;
  host::PortAddress port;  // a serial or RFC 2217 port; baud is 0 if the text has no @BAUD
};
// Parses --robot of a command for servo buses: feetech:PORT, dynamixel:PORT or PORT alone. PORT is
// PATH[@BAUD] or rfc2217:HOST:PORT[@BAUD].
Result<BusAddress> parse_bus(const std::string& text);
// Like parse_bus(), for a command that needs one protocol and one baud rate. `protocol` and `baud` are the
// values of --bus and --baud; a baud rate of 0 means that --baud was not given. The default rate is the
// servos' factory setting. Also fails if neither `text` nor `protocol` names a protocol, or if `text`
// contradicts an option.
Result<BusAddress> parse_one_bus(const std::string& text,
                                 std::optional<servo_bus::Protocol> protocol, long baud);
// Returns true for feetech:PORT and dynamixel:PORT.
bool names_servo_bus(const std::string& robot);
// Parses the values NAME=VALUE of all options --set. Rejects a repeated name.
Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts);
// Parses an interval of two numbers, 0 <= min <= max. Returns `otherwise` if `given` is empty.
Result<trials::Interval> parse_interval(const std::string& option, const std::vector<double>& given,
                                        trials::Interval otherwise);

struct Shard {
  std::uint64_t part = 1, parts = 1;  // 1 <= part <= parts
};
// Parses --shard I/N.
Result<Shard> parse_shard(const std::string& text);

}  // namespace kaz::tools
