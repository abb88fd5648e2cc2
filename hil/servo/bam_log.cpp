// Converts a servo log of BAM (Rhoban/bam), which is JSON, to the lines of a CSV log.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/bam_log.h"

#include <array>
#include <cstdio>

#include "shared/base/bounded_json.hpp"

namespace kaz::hil {
namespace {

using Json = nlohmann::json;

struct BamMotor {
  const char* name;
  double gain_per_rad;  // duty per rad and unit of kp
};
// STS3215: oscilloscope (kscalelabs/sysid). XL330: P gain / 256 in steps of 1/885 duty.
constexpr std::array kBamMotors{BamMotor{"sts3215", 0.1649},
                                BamMotor{"xl330", 4096 / 6.283185307179586 / 256 / 885}};

std::string number_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return "missing";
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", found->get<double>());
  return text;
}

Result<std::string> gain_line(const Json& log) {
  const Json motor = log.value("motor", Json());
  if (log.contains("gain_per_rad")) return "# gain_per_rad " + number_of(log, "gain_per_rad");
  for (const BamMotor& one : kBamMotors) {
    if (motor != one.name || !log.contains("kp") || !log["kp"].is_number()) continue;
    char text[60];
    std::snprintf(text, sizeof text, "# gain_per_rad %.9g",
                  one.gain_per_rad * log["kp"].get<double>());
    return text;
  }
  return fail(Fault::usage, "motor is " + json_sample(motor) +
                                ": its gain is only known for sts3215 and xl330 with a number kp; "
                                "add \"gain_per_rad\", the duty divided by the error in rad");
}

}  // namespace

Result<BamLines> bam_lines(const std::string& text) {
  const Json log = KAZ_TRY(parse_bounded_json<Json>(text));
  if (!log.is_object() || !log.contains("entries") || !log["entries"].is_array())
    return fail(Fault::usage, "has no list `entries`; give a log of BAM or a CSV log");
  BamLines lines;
  // Not within the list: an early return would leak the strings before it.
  const std::string gain = KAZ_TRY(gain_line(log));
  lines.head = {"# mass_kg " + number_of(log, "mass"), "# length_m " + number_of(log, "length"),
                gain};
  for (const auto& [name, setting] : {std::pair{"arm_mass", "arm_kg"},
                                      {"inertia_kgm2", "inertia_kgm2"},
                                      {"gravity_nm", "gravity_nm"}})
    if (log.contains(name))
      lines.head.push_back("# " + std::string(setting) + " " + number_of(log, name));
  const Json motion = log.value("trajectory", Json());
  if (motion.is_string()) lines.head.push_back("# motion " + one_line(motion.get<std::string>()));
  lines.head.emplace_back("time_s,goal_rad,position_rad,volts,torque_on");
  for (const Json& entry : log["entries"]) {
    std::string line;
    if (!entry.is_object())
      return fail(Fault::usage, "an entry is no object: " + json_sample(entry));
    for (const char* name : {"timestamp", "goal_position", "position", "input_volts"})
      line += number_of(entry, name) + ",";
    const auto on = entry.find("torque_enable");
    line += on == entry.end() || *on == true || *on == 1 ? "1"
            : *on == false || *on == 0                   ? "0"
                                                         : "missing";
    lines.entries.push_back(line);
  }
  return lines;
}

}  // namespace kaz::hil
