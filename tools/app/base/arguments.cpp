// Values of options as the user types them: ports, settings, intervals, shards.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/arguments.h"

#include <cmath>
#include <cstdio>

namespace kaz::tools {

Result<host::PortAddress> parse_port(const std::string& text) {
  return host::parse_port_address("--port", text);
}

Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> settings;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      return fail(Fault::usage, "--set " + text + ": give NAME=VALUE, as in --set seconds=20");
    const std::string name = text.substr(0, equals);
    if (!settings.emplace(name, text.substr(equals + 1)).second)
      return fail(Fault::usage, "--set " + text + ": " + name + " is set twice, give it once");
  }
  return settings;
}

Result<trials::Interval> parse_interval(const std::string& option, const std::vector<double>& given,
                                        trials::Interval otherwise) {
  if (given.empty()) return otherwise;
  if (given.size() != 2 || !(given[0] >= 0) || !(given[0] <= given[1]) ||
      !std::isfinite(given[1])) {
    char example[80];
    std::snprintf(example, sizeof example, "%g %g", otherwise.min, otherwise.max);
    return fail(Fault::usage,
                option + ": give two numbers, none below 0, the smaller one first, as in " +
                    option + " " + example);
  }
  return trials::Interval{given[0], given[1]};
}

Result<Shard> parse_shard(const std::string& text) {
  unsigned long long part = 0, parts = 0;
  int end = 0;
  if (text.size() > 20 || std::sscanf(text.c_str(), "%llu/%llu%n", &part, &parts, &end) != 2 ||
      end != static_cast<int>(text.size()) || part < 1 || part > parts)
    return fail(Fault::usage, "--shard " + text + ": give I/N, the first of four parts is 1/4");
  return Shard{part, parts};
}

}  // namespace kaz::tools
