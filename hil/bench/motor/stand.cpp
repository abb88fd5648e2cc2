// A bench's tools by words to a machine, and by words to a person.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/motor/stand.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "host/robot/posture.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/number_text.hpp"

namespace kaz::hil {
namespace {

constexpr double kMostReading = 20;  // Nm, rad, kg m2: beyond what a stand has
constexpr double kHandSpeed = 2;     // rad/s, of what turns the virtual stand's shafts

std::string joint_name(int joint) {
  return host::joint_table()[static_cast<std::size_t>(joint)].name;
}

std::string with_digits(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

double degrees(double rad) {
  return rad * 180 / std::numbers::pi;
}

}  // namespace

CommandStand::Query CommandStand::parsed(
    std::function<Result<std::string>(const std::string& line)> query) {
  return [query = std::move(query)](const std::string& line) -> Result<nlohmann::ordered_json> {
    const std::string reply = KAZ_TRY(query(line));
    return parse_bounded_json<nlohmann::ordered_json>(reply).value_or(nullptr);
  };
}

Result<void> CommandStand::send(const std::string& line) {
  const auto reply = query_(line);
  if (!reply) return tl::unexpected(reply.error());
  return {};
}

Result<double> CommandStand::number(const std::string& line, const char* key) {
  const auto reply = KAZ_TRY(query_(line));
  const auto found = reply.find(key);
  if (found == reply.end() || !found->is_number())
    return fail(Fault::environment,
                "stand " + name_ + ": its reply to `" + line + "` has no number `" + key + "`");
  const double value = found->get<double>();
  if (!(std::abs(value) <= kMostReading))
    return fail(Fault::environment, "stand " + name_ + ": its reply to `" + line +
                                        "` is out of range: `" + key + "` is " +
                                        json_sample(*found) + ", must be -20 to 20");
  return value;
}

Result<double> CommandStand::disc_kgm2() {
  return number("disc", "disc_kgm2");
}

Result<void> CommandStand::set_supply(double volts) {
  return send("supply " + with_digits(volts, 3));
}

Result<void> CommandStand::clamp(int joint, bool on) {
  return send("clamp " + joint_name(joint) + (on ? " on" : " off"));
}

Result<void> CommandStand::prepare_press(int, bool) {
  return {};
}

Result<double> CommandStand::scale_nm(int joint) {
  return number("scale " + joint_name(joint), "torque_nm");
}

Result<void> CommandStand::press(int joint, double torque_nm) {
  return send("press " + joint_name(joint) + " " + with_digits(torque_nm, 4));
}

Result<double> CommandStand::turn(int joint, double angle_rad) {
  const std::string protractor = "protractor " + joint_name(joint);
  const auto before = number(protractor, "angle_rad");
  if (!before) return before;
  KAZ_TRY(send("turn " + joint_name(joint) + " " + with_digits(angle_rad, 4)));
  const double takes = std::abs(angle_rad - *before) / kHandSpeed + settling_s();
  KAZ_TRY(clock_.sleep_until(clock_.now() + from_seconds(takes)));
  return number(protractor, "angle_rad");
}

Result<void> CommandStand::let_go(int joint) {
  return send("let " + joint_name(joint));
}

Result<void> CommandStand::put_back(double supply_volts) {
  KAZ_TRY(send("free"));
  return set_supply(supply_volts);
}

Result<void> ManualStand::done(const std::string& prompt) {
  const auto typed = prompt_(prompt + ", then press Enter");
  if (!typed) return tl::unexpected(typed.error());
  return {};
}

Result<double> ManualStand::read(const std::string& prompt) {
  std::string again;
  while (true) {
    const auto typed = KAZ_TRY(prompt_(again + prompt));
    const auto first = typed.find_first_not_of(" \t\r\n");
    const auto last = typed.find_last_not_of(" \t\r\n");
    if (first != std::string::npos)
      if (const auto value = parse_number<double>(typed.substr(first, last + 1 - first)))
        return *value;
    again = "Not a number: type one such as -0.95. ";
  }
}

Result<void> ManualStand::set_supply(double volts) {
  return done("Set the supply to " + with_digits(volts, 2) + " V without load");
}

Result<void> ManualStand::clamp(int joint, bool on) {
  if (!on) return done("Take the lever off the shaft of " + joint_name(joint));
  return done("Hold the shaft of " + joint_name(joint) +
              " by its lever against the scale, and set the scale to zero");
}

Result<void> ManualStand::prepare_press(int joint, bool positive) {
  return done("Get ready to note the last value on the scale while " + joint_name(joint) +
              " presses in its " + (positive ? "positive" : "negative") + " direction for " +
              with_digits(pressing_s(), 1) + " s");
}

Result<double> ManualStand::scale_nm(int joint) {
  return read("Value on the scale, in Nm (force times lever; negative if " + joint_name(joint) +
              " pressed in its negative direction): ");
}

Result<void> ManualStand::press(int joint, double torque_nm) {
  if (torque_nm == 0) return done("Take the weight off " + joint_name(joint));
  return done("Press gently on the shaft of " + joint_name(joint) + " with " +
              with_digits(std::abs(torque_nm), 2) + " Nm in its " +
              (torque_nm > 0 ? "positive" : "negative") + " direction, and keep pressing");
}

Result<double> ManualStand::turn(int joint, double angle_rad) {
  const auto shown =
      read("Turn " + joint_name(joint) + " to about " + with_digits(degrees(angle_rad), 0) +
           " degrees and keep it; what does the protractor show, in degrees? ");
  if (!shown) return shown;
  return *shown * std::numbers::pi / 180;
}

Result<void> ManualStand::let_go(int joint) {
  return done("Let go of " + joint_name(joint));
}

}  // namespace kaz::hil
