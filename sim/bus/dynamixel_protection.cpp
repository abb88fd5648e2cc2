// Protection of a virtual DYNAMIXEL.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/dynamixel_protection.h"

#include <algorithm>
#include <cmath>

#include "shared/dynamixel/packet.h"

namespace kaz::sim {
namespace {

constexpr double kVoltage_s = 0.1, kOverload = 0.8, kOverload_s = 2;
constexpr double kPerRev = 4096, kSecondsPerMinute = 60;

}  // namespace

void DynamixelProtection::step(RegisterFile& registers, const ServoReading& reading, double duty,
                               double step_s) {
  const servo_bus::Model& model = registers.model();
  const double sign = (registers.get("drive_mode") & 1) != 0 ? -1 : 1;
  registers.set("present_input_voltage",
                static_cast<int>(std::lround(std::max(0.0, 10 * reading.supply_volts))));
  registers.set("present_temperature",
                static_cast<int>(std::clamp(std::round(reading.case_celsius), 0.0, 255.0)));
  const double free_speed =
      model.free_rpm_per_volt * reading.supply_volts * kPerRev / kSecondsPerMinute;
  const double turning = free_speed > 0 ? reading.speed / free_speed : 0;
  const double torque = std::abs(duty) - std::max(0.0, std::copysign(1.0, duty) * turning);
  registers.set(
      "present_load",
      static_cast<int>(std::lround(1e3 * sign * std::copysign(std::max(0.0, torque), duty))));
  if (model.current_unit_a > 0)
    registers.set("present_current",
                  static_cast<int>(std::lround(sign * reading.current_a / model.current_unit_a)));

  const int volts = registers.get("present_input_voltage");
  const bool bad_voltage =
      volts > registers.get("max_voltage_limit") || volts < registers.get("min_voltage_limit");
  bad_voltage_s_ = bad_voltage ? bad_voltage_s_ + step_s : 0;
  overload_s_ = torque > kOverload ? overload_s_ + step_s : 0;
  const bool hot = registers.get("present_temperature") > registers.get("temperature_limit");
  const int now = (bad_voltage_s_ > kVoltage_s ? dynamixel::kVoltageError : 0) |
                  (hot ? dynamixel::kTemperatureError : 0) |
                  (overload_s_ > kOverload_s ? dynamixel::kOverloadError : 0);
  latched_ |= now & registers.get("shutdown");
  registers.set("hardware_error_status", now | latched_);
  if (latched_ != 0) registers.set("torque_enable", 0);
}

}  // namespace kaz::sim
