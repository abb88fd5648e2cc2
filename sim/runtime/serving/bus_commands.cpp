// Commands of the control socket of `kaz sim --bus`.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/bus_commands.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "shared/base/number_text.hpp"
#include "sim/runtime/serving/control_server.h"

namespace kaz::sim {
namespace {

using Json = nlohmann::ordered_json;

Json refusal(const std::string& why) {
  return {{"ok", false}, {"error", why}};
}

}  // namespace

Json BusCommands::answer(std::string_view line) const {
  const auto request = parse_control_request(line);
  return request ? run(request->command, request->argument) : refusal(request.error().message);
}

Json BusCommands::run(const std::string& command, const std::string& argument) const {
  const auto number = [&](double max) -> std::optional<double> {
    const auto value = parse_number<double>(argument);
    return value && *value >= 0 && *value <= max ? value : std::nullopt;
  };
  if (command == "help")
    return {{"ok", true},
            {"commands",
             {{"help", "this list"},
              {"power on|off",
               "switch the supply of all servos on or off; \"power off\" clears the servos' RAM"},
              {"supply VOLTS", "set the supply voltage, 0 to 30 V"},
              {"damage SHARE",
               "set the share of damaged bytes (0 to 1); a damaged byte has one wrong bit"},
              {"latency SECONDS",
               "set the time for which the USB adapter holds received bytes, 0 to 1 s; 0.016 is "
               "the default of FTDI's adapters"},
              {"echo on|off", "let the adapter return the host's own bytes to the host"},
              {"turn JOINT DEGREES",
               "while the joint's torque is off, turn it by hand to this angle and hold it there; "
               "\"turn off\" releases all joints"},
              {"status", "print the time, the host, lost bytes and the state of each servo"}}}};
  if (command == "power") {
    if (argument != "on" && argument != "off")
      return refusal("\"power\" takes \"on\" or \"off\", got \"" + argument + "\"");
    bus_->set_power(argument == "on");
    return {{"ok", true}};
  }
  if (command == "supply") {
    const auto volts = number(30);
    if (!volts) return refusal("\"supply\" takes volts, 0 to 30, got \"" + argument + "\"");
    bus_->set_supply_volts(*volts);
    return {{"ok", true}};
  }
  if (command == "damage") {
    const auto share = number(1);
    if (!share) return refusal("\"damage\" takes a share, 0 to 1, got \"" + argument + "\"");
    bus_->line().set_damage(*share, 1);
    return {{"ok", true}};
  }
  if (command == "latency") {
    const auto latency_s = number(1);
    if (!latency_s) return refusal("\"latency\" takes seconds, 0 to 1, got \"" + argument + "\"");
    bus_->set_adapter_latency(from_seconds(*latency_s));
    return {{"ok", true}};
  }
  if (command == "echo") {
    if (argument != "on" && argument != "off")
      return refusal("\"echo\" takes \"on\" or \"off\", got \"" + argument + "\"");
    bus_->set_adapter_echo(argument == "on");
    return {{"ok", true}};
  }
  if (command == "turn") return turn(argument);
  if (command == "status") return status();
  return refusal("there is no command \"" + command + "\"; send \"help\"");
}

Json BusCommands::turn(const std::string& argument) const {
  if (argument == "off") {
    bus_->take_hands_off();
    return {{"ok", true}};
  }
  const auto space = argument.find(' ');
  const std::string joint = argument.substr(0, space);
  const auto degrees =
      space == std::string::npos ? std::nullopt : parse_number<double>(argument.substr(space + 1));
  if (!degrees || !(std::abs(*degrees) <= 720))
    return refusal("\"turn\" takes a joint and degrees, -720 to 720, or \"off\", got \"" +
                   argument + "\"");
  for (std::size_t i = 0; i < bus_->servos(); ++i) {
    if (bus_->mount(i).joint != joint) continue;
    bus_->turn_by_hand(i, *degrees * std::numbers::pi / 180);
    return {{"ok", true}};
  }
  return refusal("there is no joint \"" + joint + "\"");
}

Json BusCommands::status() const {
  Json servos = Json::array();
  for (std::size_t i = 0; i < bus_->servos(); ++i) {
    const VirtualServo& servo = bus_->servo(i);
    const auto& counts = servo.counts();
    // By the name that Feetech gives the register, and DYNAMIXEL's.
    const auto get = [&](const char* name, const char* other = "") {
      return servo.registers().get(name, servo.registers().get(other));
    };
    servos.push_back({{"joint", bus_->mount(i).joint},
                      {"model", servo.registers().model().name},
                      {"id", get("id")},
                      {"baud", servo.baud()},
                      {"torque", get("torque_enable")},
                      {"angle_deg", bus_->angle(i) * 180 / std::numbers::pi},
                      {"position", get("present_position")},
                      {"goal", get("goal_position")},
                      {"offset", get("position_offset", "homing_offset")},
                      {"min_angle", get("min_angle", "min_position_limit")},
                      {"max_angle", get("max_angle", "max_position_limit")},
                      {"status", get("status", "hardware_error_status")},
                      {"celsius", get("present_temperature")},
                      {"volts", bus_->volts(i)},
                      {"executed", servo.executed()},
                      {"bad_checksums", counts.bad_checksums},
                      {"bad_lengths", counts.bad_lengths},
                      {"abandoned", counts.abandoned},
                      {"skipped_bytes", counts.skipped_bytes},
                      {"framing_errors", servo.framing_errors()}});
  }
  Json reply{{"ok", true}};
  reply.update(serving_());
  reply["volts"] = bus_->volts();
  reply["servos"] = servos;
  return reply;
}

}  // namespace kaz::sim
