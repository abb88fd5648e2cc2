// Values of options as the user types them: ports, settings, intervals, shards.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/arguments.h"

#include <cmath>
#include <cstdio>

#include "shared/base/one_line.hpp"

namespace kaz::tools {

namespace {

// The protocol whose name and a colon begin `text`.
std::optional<servo_bus::Protocol> bus_protocol(std::string_view text) {
  for (const auto protocol : {servo_bus::Protocol::feetech, servo_bus::Protocol::dynamixel}) {
    if (text.starts_with(std::string(servo_bus::name_of(protocol)) + ":")) return protocol;
  }
  return std::nullopt;
}

}  // namespace

Result<host::PortAddress> parse_port(const std::string& text) {
  if (names_servo_bus(text))
    return fail(Fault::usage, "--robot " + shown_text(text) +
                                  ": a servo bus is not valid here; for servos use `kaz bus "
                                  "status`, `kaz bus scan` or `kaz monitor`");
  return host::parse_port_address("--robot", text);
}

Result<BusAddress> parse_bus(const std::string& text) {
  BusAddress bus{bus_protocol(text), {}};
  const std::string port =
      bus.protocol ? text.substr(servo_bus::name_of(*bus.protocol).size() + 1) : text;
  const auto parsed = host::parse_port_address("--robot", port);
  if (!parsed ||
      (parsed->kind != host::PortKind::serial && parsed->kind != host::PortKind::rfc2217))
    return fail(Fault::usage, "--robot " + shown_text(text) +
                                  ": not a servo bus; give feetech:PATH[@BAUD] or "
                                  "dynamixel:PATH[@BAUD], such as feetech:/dev/ttyACM0, or "
                                  "feetech:rfc2217:HOST:PORT for a port on another machine");
  bus.port = *parsed;
  if (port.find('@') == std::string::npos) bus.port.baud = 0;
  return bus;
}

Result<BusAddress> parse_one_bus(const std::string& text,
                                 std::optional<servo_bus::Protocol> protocol, long baud) {
  BusAddress bus = KAZ_TRY(parse_bus(text));
  if (bus.protocol && protocol && bus.protocol != protocol)
    return fail(Fault::usage, "--bus " + std::string(servo_bus::name_of(*protocol)) + ": --robot " +
                                  shown_text(text) + " uses another protocol; leave --bus out");
  if (!bus.protocol) bus.protocol = protocol;
  if (!bus.protocol)
    return fail(Fault::usage, "--robot " + shown_text(text) +
                                  ": its protocol is missing; give feetech:" + shown_text(text) +
                                  " or dynamixel:" + shown_text(text));
  if (bus.port.baud != 0 && baud != 0 && bus.port.baud != baud)
    return fail(Fault::usage, "--baud " + std::to_string(baud) + ": --robot " + shown_text(text) +
                                  " has another rate; leave --baud out");
  if (bus.port.baud == 0)
    bus.port.baud = static_cast<int>(baud != 0 ? baud : servo_bus::factory_baud(*bus.protocol));
  return bus;
}

bool names_servo_bus(const std::string& robot) {
  return bus_protocol(robot).has_value();
}

Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> settings;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      return fail(Fault::usage,
                  "--set " + shown_text(text) + ": give NAME=VALUE, as in --set seconds=20");
    const std::string name = text.substr(0, equals);
    if (!settings.emplace(name, text.substr(equals + 1)).second)
      return fail(Fault::usage, "--set " + shown_text(text) + ": " + shown_text(name) +
                                    " is set twice; give it once");
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
                option + ": give two numbers of at least 0, the smaller one first, such as " +
                    option + " " + example);
  }
  return trials::Interval{given[0], given[1]};
}

Result<Shard> parse_shard(const std::string& text) {
  unsigned long long part = 0, parts = 0;
  int end = 0;
  if (text.size() > 20 || std::sscanf(text.c_str(), "%llu/%llu%n", &part, &parts, &end) != 2 ||
      end != static_cast<int>(text.size()) || part < 1 || part > parts)
    return fail(Fault::usage, "--shard " + shown_text(text) +
                                  ": give I/N, such as 1/4 for the first of four parts");
  return Shard{part, parts};
}

}  // namespace kaz::tools
