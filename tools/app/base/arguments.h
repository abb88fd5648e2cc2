// Values of options as the user types them: ports, settings, intervals, shards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/link/port_address.h"
#include "shared/base/result.hpp"
#include "tools/trials/statistics.h"

namespace kaz::tools {

// Errors of all: usage, with the option and an example.

// --port, as host/link/port_address.h has it.
Result<host::PortAddress> parse_port(const std::string& text);
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
