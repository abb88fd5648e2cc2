// Executes the commands that the control socket of `kaz sim --bus` receives: `power`, `supply`, `damage`,
// `turn`, `status`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "sim/bus/virtual_bus.h"

namespace kaz::sim {

class BusCommands {
 public:
  // `serving` returns the part of the status that describes the server. `bus` must outlive this object.
  BusCommands(VirtualBus& bus, std::function<nlohmann::ordered_json()> serving)
      : bus_(&bus), serving_(std::move(serving)) {}
  // Executes one request: plain words, or JSON such as {"command": "power", "argument": "off"}. The reply
  // contains "ok". If "ok" is false, the reply also contains "error".
  nlohmann::ordered_json answer(std::string_view line) const;

 private:
  nlohmann::ordered_json run(const std::string& command, const std::string& argument) const;
  nlohmann::ordered_json turn(const std::string& argument) const;
  nlohmann::ordered_json status() const;

  VirtualBus* bus_;
  std::function<nlohmann::ordered_json()> serving_;
};

}  // namespace kaz::sim
