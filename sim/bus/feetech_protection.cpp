// Protection of a virtual servo of Feetech's.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/feetech_protection.h"

#include <algorithm>
#include <cmath>

#include "shared/feetech/packet.h"

namespace kaz::sim {
namespace {

constexpr double kCurrentUnit_a = 6.5e-3;
constexpr double kOvercurrentUnit_s = 0.01;

bool acts(const RegisterFile& registers, feetech::StatusBit bit) {
  return (registers.get("unload_condition") & bit) != 0;
}

}  // namespace

double FeetechProtection::limit(const RegisterFile& registers) const {
  if (overcurrent_ && acts(registers, feetech::kCurrentError)) return 0;
  if (bad_voltage_ && acts(registers, feetech::kVoltageError)) return 0;
  if (overloaded_ && acts(registers, feetech::kOverloadError))
    return 1e-2 * registers.get("protective_torque");
  return 1;
}

void FeetechProtection::step(RegisterFile& registers, const ServoReading& reading, double duty,
                             double step_s) {
  const double volts = 10 * reading.supply_volts, celsius = std::round(reading.case_celsius);
  registers.set("present_voltage", static_cast<int>(std::lround(std::clamp(volts, 0.0, 254.0))));
  registers.set("present_temperature", static_cast<int>(std::clamp(celsius, 0.0, 254.0)));
  registers.set("present_current",
                static_cast<int>(std::lround(reading.current_a / kCurrentUnit_a)));

  const double free_speed = registers.get("max_speed") * registers.get("speed_unit");
  const double turning = free_speed > 0 ? reading.speed / free_speed : 0;
  const double torque = std::abs(duty) - std::max(0.0, std::copysign(1.0, duty) * turning);
  overload_s_ = 100 * torque > registers.get("overload_torque") ? overload_s_ + step_s : 0;
  const double overload_limit =
      1e-3 * registers.model().protection_unit_ms * registers.get("protection_time");
  if (overload_s_ > overload_limit) overloaded_ = true;

  const bool high =
      registers.has("protection_current") &&
      std::abs(registers.get("present_current")) > registers.get("protection_current");
  overcurrent_s_ = high ? overcurrent_s_ + step_s : 0;
  if (overcurrent_s_ > kOvercurrentUnit_s * registers.get("overcurrent_time")) overcurrent_ = true;

  bad_voltage_ = registers.get("present_voltage") > registers.get("max_voltage") ||
                 registers.get("present_voltage") < registers.get("min_voltage");
  const bool hot = registers.get("present_temperature") > registers.get("max_temperature");
  if (hot && acts(registers, feetech::kTemperatureError)) registers.set("torque_enable", 0);
  registers.set("status", (bad_voltage_ ? feetech::kVoltageError : 0) |
                              (hot ? feetech::kTemperatureError : 0) |
                              (overcurrent_ ? feetech::kCurrentError : 0) |
                              (overloaded_ ? feetech::kOverloadError : 0));
}

}  // namespace kaz::sim
