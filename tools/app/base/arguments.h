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

// All functions fail with Fault::usage. The message contains the option and an example.

// Parses --robot of a command for servo boards (host/link/port_address.h). A path without a kind means
// serial:PATH. Rejects servo buses.
Result<host::PortAddress> parse_port(const std::string& text);

struct BusAddress {
  std::optional<servo_bus::Protocol> protocol;  // empty if the text contains only a port
  host::PortAddress port;  // serial or rfc2217; baud is 0 if the text has no @BAUD
};
// Parses --robot of a command for servo buses: feetech:PORT, dynamixel:PORT or PORT alone. PORT is
// PATH[@BAUD] or rfc2217:HOST:PORT[@BAUD].
Result<BusAddress> parse_bus(const std::string& text);
// Like parse_bus(), for a command that needs one protocol and one baud rate. `protocol` and `baud` come from
// --bus and --baud; 0 means no --baud. The default rate is the servos' factory setting. Also fails if there
// is no protocol, or if the options contradict each other.
Result<BusAddress> parse_one_bus(const std::string& text,
                                 std::optional<servo_bus::Protocol> protocol, long baud);
// Returns true for feetech:PORT and dynamixel:PORT.
bool names_servo_bus(const std::string& robot);
// Parses all --set NAME=VALUE. Rejects a repeated name.
Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts);
// Parses two numbers, 0 <= min <= max. Returns `otherwise` if `given` is empty.
Result<trials::Interval> parse_interval(const std::string& option, const std::vector<double>& given,
                                        trials::Interval otherwise);

struct Shard {
  std::uint64_t part = 1, parts = 1;  // 1 <= part <= parts
};
// Parses --shard I/N.
Result<Shard> parse_shard(const std::string& text);

}  // namespace kaz::tools
