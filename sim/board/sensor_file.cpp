// The sensor file: reads and checks the parameters of the board's sensors.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/sensor_file.h"

#include <array>
#include <limits>
#include <sstream>

#include "shared/base/angle.hpp"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {
namespace {

constexpr double kGravity = 9.80665;  // m/s^2 in one g, by definition
constexpr double kAny = std::numeric_limits<double>::max();

struct Param {
  const char* section;
  const char* element;
  double& (*of)(SensorParams&);
  double min, max;  // inclusive, in the file's unit
  double unit;      // the file's, in that of the struct
};

using F = SensorParams;
constexpr const char* kPot = "potentiometer";
constexpr const char* kDriver = "driver_temperature";
constexpr const char* kAccel = "accelerometer";
// Lower bound of values that must not be zero.
constexpr double kTiny = 1e-6;

constexpr std::array<Param, 26> kParams{{
    {kPot, "noise", [](F& f) -> double& { return f.potentiometer.noise_codes; }, 0, 1024, 1},
    {kPot, "linearity", [](F& f) -> double& { return f.potentiometer.linearity; }, 0, 0.05, 1},
    {kPot, "mounting", [](F& f) -> double& { return f.potentiometer.mounting_rad; }, 0, 90,
     kDegree},
    {kPot, "terminal", [](F& f) -> double& { return f.potentiometer.terminal_rad; }, 0, 85,
     kDegree},
    {kPot, "open_level", [](F& f) -> double& { return f.potentiometer.open_level; }, 0, 1, 1},
    {"supply", "noise", [](F& f) -> double& { return f.supply.noise_codes; }, 0, 1024, 1},
    {"reference", "noise", [](F& f) -> double& { return f.reference.noise_codes; }, 0, 1024, 1},
    {kDriver, "noise", [](F& f) -> double& { return f.driver.noise_codes; }, 0, 1024, 1},
    {kDriver, "ambient", [](F& f) -> double& { return f.driver.ambient_celsius; }, -40, 100, 1},
    {kDriver, "bridge_drop", [](F& f) -> double& { return f.driver.drop_volts; }, 0, 10, 1},
    {kDriver, "thermal_resistance", [](F& f) -> double& { return f.driver.kelvin_per_watt; }, 0,
     kAny, 1},
    {kDriver, "time_constant", [](F& f) -> double& { return f.driver.time_constant_s; }, kTiny,
     kAny, 1},
    {"gyro", "scale", [](F& f) -> double& { return f.gyro.share_per_unit; }, kTiny, kAny,
     1 / kDegree},
    {"gyro", "zero_offset", [](F& f) -> double& { return f.gyro.zero_offset; }, 0, kAny, kDegree},
    {"gyro", "wander", [](F& f) -> double& { return f.gyro.wander; }, 0, kAny, kDegree},
    {"gyro", "wander_time", [](F& f) -> double& { return f.gyro.wander_time_s; }, kTiny, kAny, 1},
    {"gyro", "bandwidth", [](F& f) -> double& { return f.gyro.bandwidth_hz; }, kTiny, kAny, 1},
    {"gyro", "noise_density", [](F& f) -> double& { return f.gyro.noise_density; }, 0, kAny,
     kDegree},
    {"gyro", "range", [](F& f) -> double& { return f.gyro.range; }, kTiny, kAny, kDegree},
    {kAccel, "scale", [](F& f) -> double& { return f.accelerometer.share_per_unit; }, kTiny, kAny,
     1 / kGravity},
    {kAccel, "zero_offset", [](F& f) -> double& { return f.accelerometer.zero_offset; }, 0, kAny,
     kGravity},
    {kAccel, "wander", [](F& f) -> double& { return f.accelerometer.wander; }, 0, kAny, kGravity},
    {kAccel, "wander_time", [](F& f) -> double& { return f.accelerometer.wander_time_s; }, kTiny,
     kAny, 1},
    {kAccel, "bandwidth", [](F& f) -> double& { return f.accelerometer.bandwidth_hz; }, kTiny, kAny,
     1},
    {kAccel, "noise_density", [](F& f) -> double& { return f.accelerometer.noise_density; }, 0,
     kAny, kGravity},
    {kAccel, "range", [](F& f) -> double& { return f.accelerometer.range; }, kTiny, kAny, kGravity},
}};

std::string shown(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

bool has_section(const std::string& name) {
  for (const Param& param : kParams) {
    if (name == param.section) return true;
  }
  return false;
}

Result<void> read_param(const XmlFile& file, const tinyxml2::XMLElement& section,
                        const tinyxml2::XMLElement& element, std::array<bool, kParams.size()>& seen,
                        SensorParams& params) {
  const std::string in = section.Name(), name = element.Name();
  std::size_t which = 0;
  while (which < kParams.size() && (in != kParams[which].section || name != kParams[which].element))
    ++which;
  if (which == kParams.size())
    return file.error(element, "unknown element <" + name + "> in <" + in +
                                   ">; shared/robot/kaz/sensors.xml lists the supported elements");
  if (seen[which])
    return file.error(element, "<" + name + "> occurs twice in <" + in + ">; remove one");
  const Result<double> value = file.number(element, "value");
  if (!value) return tl::unexpected(value.error());
  const Param& param = kParams[which];
  if (*value < param.min || *value > param.max) {
    std::string wanted = "at least " + shown(param.min);
    if (param.max < kAny) wanted += " and at most " + shown(param.max);
    return file.error(element, "<" + name + "> of <" + in + "> must be " + wanted);
  }
  param.of(params) = *value * param.unit;
  seen[which] = true;
  return {};
}

}  // namespace

SensorSwitches sensor_switches(SensorSet set) {
  switch (set) {
    case SensorSet::ideal:
      return SensorSwitches::ideal();
    case SensorSet::as_built:
      return SensorSwitches::as_built();
    case SensorSet::nominal:
      break;
  }
  return {};
}

Result<SensorParams> load_sensor_file(const std::string& path) {
  const Result<XmlFile> file = XmlFile::load(path, "sensors");
  if (!file) return tl::unexpected(file.error());
  SensorParams params;
  std::array<bool, kParams.size()> seen{};
  const auto& root = file->root();
  for (auto* section = root.FirstChildElement(); section; section = section->NextSiblingElement()) {
    if (!has_section(section->Name()))
      return file->error(*section,
                         std::string("unknown sensor <") + section->Name() +
                             ">; shared/robot/kaz/sensors.xml lists the supported sensors");
    for (auto* e = section->FirstChildElement(); e; e = e->NextSiblingElement()) {
      KAZ_TRY(read_param(*file, *section, *e, seen, params));
    }
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i]) continue;
    const auto* section = root.FirstChildElement(kParams[i].section);
    return file->error(
        section != nullptr ? *section : root,
        std::string("<") + kParams[i].section + "> lacks <" + kParams[i].element + ">");
  }
  return params;
}

}  // namespace kaz::sim
