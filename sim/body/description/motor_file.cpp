// The motor file: parameters of the gear motor that drives each joint.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/motor_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <numbers>
#include <vector>

#include "shared/base/one_line.hpp"
#include "shared/base/xml_text.hpp"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

enum class Need { always, with_heat, never };
// Whether a motor with <servo> may have the element.
enum class WithServo { allowed, winding, refused };

struct Param {
  const char* element;
  double MotorParams::*member;
  double min;
  bool min_allowed;
  Need need = Need::always;
  double unit = 1;
  WithServo with_servo = WithServo::allowed;
};

constexpr double kColdest = -273.15;
// Bounds of parameters: far beyond any motor's, and such that ratios of them are finite (resistance_ohm()).
constexpr double kSmallest = 1e-12, kLargest = 1e9;
constexpr std::array<Param, 13> kParams{{
    {"stall_slope", &MotorParams::stall_slope_nm_per_v, 0, false, Need::always, 1,
     WithServo::winding},
    {"friction", &MotorParams::friction_nm, 0, true, Need::always, 1, WithServo::refused},
    {"back_emf", &MotorParams::back_emf_nms_per_rad, 0, false, Need::always, 1, WithServo::winding},
    {"stiction_ratio", &MotorParams::stiction_ratio, 1, true, Need::always, 1, WithServo::refused},
    {"rotor_inertia", &MotorParams::rotor_inertia_kgm2, 0, false, Need::always, 1,
     WithServo::refused},
    {"max_supply", &MotorParams::max_supply_v, 0, false},
    {"backlash_degrees", &MotorParams::backlash_rad, 0, true, Need::never, std::numbers::pi / 180,
     WithServo::refused},
    {"winding_heat_capacity", &MotorParams::winding_heat_capacity, 0, false, Need::with_heat},
    {"winding_to_case", &MotorParams::winding_to_case, 0, false, Need::with_heat},
    {"case_heat_capacity", &MotorParams::case_heat_capacity, 0, false, Need::with_heat},
    {"case_to_air", &MotorParams::case_to_air, 0, false, Need::with_heat},
    {"copper_per_kelvin", &MotorParams::copper_per_kelvin, 0, true, Need::with_heat},
    {"air_celsius", &MotorParams::air_celsius, kColdest, false, Need::never},
}};
using Seen = std::array<bool, kParams.size()>;

struct Motor {
  MotorParams params;
  Seen seen{};
};

Result<void> read_param(const XmlFile& file, const tinyxml2::XMLElement& element, Motor& motor,
                        Seen& read) {
  std::size_t which = 0;
  while (which < kParams.size() && std::string(element.Name()) != kParams[which].element) ++which;
  if (which == kParams.size()) {
    return file.error(element,
                      std::string("unknown element <") + element.Name() +
                          "> in <motor>; docs/reference/robot.md lists the supported elements");
  }
  const Result<double> value = file.number(element, "value");
  if (!value) return tl::unexpected(value.error());
  const Param& param = kParams[which];
  if (*value < param.min || (*value == param.min && !param.min_allowed)) {
    return file.error(element, std::string("<") + param.element + "> must be " +
                                   (param.min_allowed ? "at least " : "more than ") +
                                   std::to_string(static_cast<int>(param.min)));
  }
  if (*value > kLargest || (!param.min_allowed && *value < param.min + kSmallest)) {
    return file.error(element,
                      std::string("<") + param.element + "> is out of range: give 1e-12 to 1e9");
  }
  if (read[which]) {
    return file.error(element,
                      std::string("<") + param.element + "> occurs twice in <motor>; remove one");
  }
  if (motor.params.servo && param.with_servo == WithServo::refused) {
    return file.error(element, std::string("<") + param.element +
                                   "> has no effect with <servo>, which replaces it; remove one");
  }
  read[which] = true;
  motor.params.*param.member = *value * param.unit;
  motor.seen[which] = true;
  return {};
}

// A shipped servo by its name, or a file beside the motor file.
Result<servo_model::IdentifiedServo> servo_of(const XmlFile& file,
                                              const tinyxml2::XMLElement& element) {
  const char *name = element.Attribute("name"), *path = element.Attribute("file");
  if ((name == nullptr) == (path == nullptr))
    return fail(Fault::usage, "must have either the attribute `name` or the attribute `file`");
  if (name != nullptr) return servo_model::shipped_servo(name);
  return servo_model::load_servo_file(std::filesystem::path(file.path()).replace_filename(path));
}

// Reads the servo and sets the numbers that it replaces.
Result<void> read_servo(const XmlFile& file, const tinyxml2::XMLElement& element, Motor& motor) {
  auto servo = servo_of(file, element);
  if (!servo) {
    auto failed = file.error(element, "<servo>: " + servo.error().message);
    failed.value().details = servo.error().details;
    return failed;
  }
  use_servo(motor.params, std::move(*servo));
  for (std::size_t i = 0; i < kParams.size(); ++i)
    motor.seen[i] = motor.seen[i] || kParams[i].with_servo != WithServo::allowed;
  return {};
}

// <servo> comes first, so that other elements can replace its winding, in any order.
Result<void> read_servos(const XmlFile& file, const tinyxml2::XMLElement& element, Motor& motor) {
  const auto* servo = element.FirstChildElement("servo");
  if (servo == nullptr) return {};
  if (const auto* second = servo->NextSiblingElement("servo"))
    return file.error(*second, "<servo> occurs twice in <motor>; remove one");
  return read_servo(file, *servo, motor);
}

// With <servo>, only both numbers of the winding can be replaced: each has the winding's resistance in it.
Result<void> check_winding(const XmlFile& file, const tinyxml2::XMLElement& element,
                           const Motor& motor, const Seen& read) {
  for (std::size_t i = 0; i < kParams.size() && motor.params.servo; ++i) {
    for (std::size_t k = 0; k < kParams.size(); ++k) {
      const bool pair = kParams[i].with_servo == WithServo::winding &&
                        kParams[k].with_servo == WithServo::winding;
      if (pair && read[i] && !read[k])
        return file.error(element, std::string("<motor> replaces <") + kParams[i].element +
                                       "> of <servo>, but not <" + kParams[k].element +
                                       ">; give both");
    }
  }
  return {};
}

// `motor` comes with what it is based on.
Result<void> read_motor(const XmlFile& file, const tinyxml2::XMLElement& element, Motor& motor) {
  KAZ_TRY(file.check_no_text(element));
  Seen read{};
  KAZ_TRY(read_servos(file, element, motor));
  for (auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (std::string(child->Name()) == "servo") continue;
    if (auto done = read_param(file, *child, motor, read); !done) return done;
  }
  KAZ_TRY(check_winding(file, element, motor, read));
  bool heat = false;
  for (std::size_t i = 0; i < kParams.size(); ++i) {
    heat = heat || (kParams[i].need == Need::with_heat && motor.seen[i]);
  }
  for (std::size_t i = 0; i < kParams.size(); ++i) {
    if (motor.seen[i] || kParams[i].need == Need::never) continue;
    if (kParams[i].need == Need::with_heat && !heat) continue;
    return file.error(element, std::string("<motor> lacks <") + kParams[i].element + ">");
  }
  return {};
}

std::string names_of(const std::vector<Motor>& motors) {
  std::string names;
  for (const Motor& motor : motors) {
    if (!names.empty()) names += ", ";
    names += motor.params.name;
  }
  return names;
}

const Motor* find(const std::vector<Motor>& motors, const std::string& name) {
  const auto found = std::find_if(motors.begin(), motors.end(),
                                  [&](const Motor& motor) { return motor.params.name == name; });
  return found == motors.end() ? nullptr : &*found;
}

}  // namespace

MotorParams MotorParams::ideal() const {
  MotorParams params = *this;
  params.backlash_rad = 0;
  params.winding_heat_capacity = 0;
  return params;
}

void use_servo(MotorParams& motor, servo_model::IdentifiedServo servo) {
  const servo_model::ServoParams params = servo.params();
  motor.servo = std::make_shared<const servo_model::IdentifiedServo>(std::move(servo));
  motor.stall_slope_nm_per_v = params.kt / params.resistance;
  motor.back_emf_nms_per_rad = params.kt * params.kt / params.resistance;
  motor.rotor_inertia_kgm2 = params.armature;
  motor.friction_nm = motor.backlash_rad = 0;
  motor.stiction_ratio = 1;
}

Result<MotorParams> load_motor_file(const std::string& path, const std::string& name) {
  const Result<XmlFile> file = XmlFile::load(path, "motors");
  if (!file) return tl::unexpected(file.error());
  std::string wanted = name;
  if (wanted.empty()) {
    const Result<std::string> standard = file->attribute(file->root(), "default");
    if (!standard) return tl::unexpected(standard.error());
    wanted = *standard;
  }
  KAZ_TRY(file->check_no_text(file->root()));
  std::vector<Motor> motors;
  for (auto* element = file->root().FirstChildElement(); element;
       element = element->NextSiblingElement()) {
    if (std::string(element->Name()) != "motor") {
      return file->error(
          *element, std::string("unknown element <") + element->Name() + ">, expected <motor>");
    }
    const Result<std::string> its_name = file->attribute(*element, "name");
    if (!its_name) return tl::unexpected(its_name.error());
    // As xml_text() writes it; XML has no form for control characters.
    if (one_line(*its_name) != *its_name)
      return file->error(*element, "the name `" + one_line(*its_name) +
                                       "` of <motor> contains a control character; remove it");
    Motor motor;
    if (const char* base = element->Attribute("based_on")) {
      const Motor* known = find(motors, base);
      if (!known) {
        return file->error(*element, std::string("is based on motor `") + base +
                                         "`, which is not defined above; defined above: " +
                                         (motors.empty() ? "none" : names_of(motors)));
      }
      motor = *known;
    }
    motor.params.name = *its_name;
    KAZ_TRY(read_motor(*file, *element, motor));
    motors.push_back(motor);
  }
  const Motor* found = find(motors, wanted);
  if (found) return found->params;
  return file->error(file->root(), "has no motor `" + wanted + "`; it has: " + names_of(motors));
}

std::string motor_file_text(const MotorParams& motor, const std::string& about) {
  std::string comment = about;
  for (auto at = comment.find("--"); at != std::string::npos; at = comment.find("--", at))
    comment[at + 1] = ' ';  // "--" is not allowed in XML comments
  const std::string name = xml_text(motor.name);
  std::string text = "<?xml version=\"1.0\"?>\n<!-- " + comment + " -->\n<motors default=\"" +
                     name + "\">\n  <motor name=\"" + name + "\">\n";
  for (const Param& param : kParams) {
    if (param.need == Need::with_heat && motor.winding_heat_capacity == 0) continue;
    char number[40];
    const auto end =
        std::to_chars(number, number + sizeof number, motor.*param.member / param.unit);
    text += std::string("    <") + param.element + " value=\"" + std::string(number, end.ptr) +
            "\"/>\n";
  }
  return text + "  </motor>\n</motors>\n";
}

}  // namespace kaz::sim
