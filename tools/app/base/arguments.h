// Values of options as the user types them: ports, settings, intervals, shards.
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

// Errors of all: usage, with the option and an example.

// --robot of a verb for servo boards (host/link/port_address.h). A path without a kind is accepted as
// serial:PATH.
Result<host::PortAddress> parse_port(const std::string& text);

struct BusAddress {
  std::optional<servo_bus::Protocol> protocol;  // none: the text names only a port
  host::PortAddress port;  // serial or rfc2217; baud is 0 if the text has no @BAUD
};
// --robot of a verb for servo buses: feetech:PORT or dynamixel:PORT, where PORT is PATH[@BAUD] or
// rfc2217:HOST:PORT[@BAUD]; or PORT alone.
Result<BusAddress> parse_bus(const std::string& text);
// The same for a verb that needs one protocol and one rate. `protocol` and `baud` come from --bus and --baud;
// without a rate it is that of servos as they are sold. Errors: no protocol, or the two places contradict
// each other.
Result<BusAddress> parse_one_bus(const std::string& text,
                                 std::optional<servo_bus::Protocol> protocol, long baud);
// True for feetech:PORT and dynamixel:PORT.
bool names_servo_bus(const std::string& robot);
// --set NAME=VALUE, each; a name only once.
Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts);
// Two numbers, none below 0, the smaller one first; `otherwise` if none are given.
Result<trials::Interval> parse_interval(const std::string& option, const std::vector<double>& given,
                                        trials::Interval otherwise);

struct Shard {
  std::uint64_t part = 1, parts = 1;  // part 1..parts
};
// --shard I/N
Result<Shard> parse_shard(const std::string& text);

}  // namespace kaz::tools
