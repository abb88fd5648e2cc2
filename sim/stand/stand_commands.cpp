// Text commands for a motor stand's tools.
// SPDX-License-Identifier: Apache-2.0
#include "sim/stand/stand_commands.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <vector>

#include "shared/base/number_text.hpp"
#include "sim/body/description/robot_model.h"

namespace kaz::sim {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxVolts = 15;  // of the supply; above the rating of the board's motors
constexpr double kMaxPress = 1;   // Nm
constexpr double kMaxTurn = 4;    // rad

Result<double> number(const std::string& word, const std::string& what, double low, double high) {
  const auto value = parse_number<double>(word);
  if (!value || *value < low || *value > high) {
    std::ostringstream bounds;
    bounds << what << " must be " << low << " to " << high;
    return fail(Fault::usage, bounds.str() + ", got `" + word + "`");
  }
  return *value;
}

Result<std::size_t> joint_of(const std::string& word) {
  const auto& names = joint_names();
  const auto found = std::ranges::find(names, word);
  if (found == names.end())
    return fail(Fault::usage,
                "there is no joint `" + word + "`; docs/reference/robot.md lists the joints");
  return static_cast<std::size_t>(found - names.begin());
}

struct Words {
  std::string command;
  std::vector<std::string> arguments;
};

Words words_of(const std::string& line) {
  std::istringstream from(line);
  Words words;
  from >> words.command;
  for (std::string word; from >> word;) words.arguments.push_back(word);
  return words;
}

// "-1 to 1 Nm"
std::string within(double low, double high, const char* unit) {
  std::ostringstream text;
  text << low << " to " << high << " " << unit;
  return text.str();
}

const Json kHelp = {
    {"disc", "print the inertia of the disc on each shaft"},
    {"free",
     "remove lever, weight and hand from every shaft, and restore the initial supply voltage"},
    {"supply V", "set the supply's voltage without load, " + within(0, kMaxVolts, "V")},
    {"clamp JOINT on|off",
     "on: clamp the shaft with a lever that presses on the scale; off: remove the lever; both set "
     "the scale to zero"},
    {"scale JOINT", "print the torque on the scale"},
    {"press JOINT NM",
     "put a weight on the shaft, " + within(-kMaxPress, kMaxPress, "Nm") + "; 0 removes it"},
    {"turn JOINT RAD", "turn the shaft by hand to this angle, " +
                           within(-kMaxTurn, kMaxTurn, "rad") + ", and hold it"},
    {"let JOINT", "release the shaft from the hand"},
    {"protractor JOINT", "print the angle of the shaft"}};

// Commands about one joint.
Result<Json> answer_joint(MotorStand& stand, const Words& words, std::size_t joint) {
  const std::string& command = words.command;
  if (command == "scale") return Json{{"torque_nm", stand.scale_nm(joint)}};
  if (command == "protractor") return Json{{"angle_rad", stand.protractor_rad(joint)}};
  if (command == "let") {
    stand.release(joint);
    return Json::object();
  }
  const std::string& word = words.arguments[1];
  if (command == "clamp") {
    if (word != "on" && word != "off")
      return fail(Fault::usage, "`clamp` takes a joint and on or off, got `" + word + "`");
    stand.clamp(joint, word == "on");
    return Json::object();
  }
  if (command == "press") {
    const auto torque = KAZ_TRY(number(word, "a weight's torque in Nm", -kMaxPress, kMaxPress));
    stand.press(joint, torque);
    return Json::object();
  }
  const auto angle = KAZ_TRY(number(word, "an angle in rad", -kMaxTurn, kMaxTurn));
  stand.turn(joint, angle);
  return Json::object();
}

// Number of words after the command; nullopt: unknown command.
std::optional<std::size_t> arguments_of(const std::string& command) {
  for (const auto& [form, text] : kHelp.items()) {
    const Words words = words_of(form);
    if (words.command == command) return words.arguments.size();
  }
  return command == "help" ? std::optional<std::size_t>(0) : std::nullopt;
}

}  // namespace

Result<std::unique_ptr<Simulation>> make_stand(const SimulationOptions& options,
                                               const StandOptions& stand) {
  if (stand.motor.servo)
    return fail(Fault::usage, "the motor `" + stand.motor.name +
                                  "` has a <servo>: a motor stand needs a motor without <servo>");
  // A laboratory supply with short thick wires, where the robot has a battery and a switch.
  SimulationOptions wired = options;
  wired.supply_ohms = 0.02;
  auto mcu = KAZ_TRY(make_mcu(options));
  StandOptions supplied = stand;
  supplied.supply_volts = options.supply_volts;
  return Simulation::assemble(wired, std::move(mcu), std::make_unique<MotorStand>(supplied), {});
}

MotorStand* stand_of(Simulation& simulation) {
  return dynamic_cast<MotorStand*>(&simulation.world());
}

Result<Json> answer_stand(Simulation& simulation, const std::string& line) {
  MotorStand& stand = *stand_of(simulation);
  const Words words = words_of(line);
  const auto wanted = arguments_of(words.command);
  if (!wanted)
    return fail(Fault::usage, "there is no command `stand" +
                                  (words.command.empty() ? "" : " " + words.command) +
                                  "`; `stand help` lists them");
  if (words.arguments.size() != *wanted)
    return fail(Fault::usage, "`stand " + words.command + "` takes " + std::to_string(*wanted) +
                                  " words, got " + std::to_string(words.arguments.size()));
  if (words.command == "help") return Json{{"commands", kHelp}};
  if (words.command == "disc") return Json{{"disc_kgm2", stand.disc_kgm2()}};
  if (words.command == "free") {
    simulation.board().set_supply(stand.first_supply_volts());
    return Json{{"freed", stand.free_all()}, {"supply_v", stand.first_supply_volts()}};
  }
  if (words.command == "supply") {
    const auto volts = KAZ_TRY(number(words.arguments[0], "the supply in V", 0, kMaxVolts));
    simulation.board().set_supply(volts);
    return Json::object();
  }
  const auto joint = KAZ_TRY(joint_of(words.arguments[0]));
  return answer_joint(stand, words, joint);
}

}  // namespace kaz::sim
