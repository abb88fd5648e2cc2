// Drivers by protocol, and writes whose result is checked.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/bus_driver.h"

#include "host/bus/dynamixel_driver.h"
#include "host/bus/feetech_driver.h"

namespace kaz::host {

std::unique_ptr<BusDriver> BusDriver::make(servo_bus::Protocol protocol, Link& link, Clock& clock) {
  if (protocol == servo_bus::Protocol::dynamixel)
    return std::make_unique<DynamixelDriver>(link, clock);
  return std::make_unique<FeetechDriver>(link, clock);
}

std::string named(const servo_bus::BusServo& servo) {
  return "servo " + std::to_string(servo.id) + " (" + servo.joint + ")";
}

std::string bus_option(servo_bus::Protocol protocol, const std::string& port_name) {
  return "--robot " + std::string(servo_bus::name_of(protocol)) + ":" + port_name;
}

std::string still_on(BusDriver::Servos servos, std::span<const BusDriver::Torque> torque) {
  std::string text;
  for (std::size_t i = 0; i < servos.size(); ++i) {
    if (torque[i] == BusDriver::Torque::off) continue;
    text += (text.empty() ? "" : "; ") + servos[i]->joint + " (id " +
            std::to_string(servos[i]->id) + ")" +
            (torque[i] == BusDriver::Torque::on ? " still has torque"
                                                : " does not confirm that its torque is off");
  }
  return text.empty() ? text : text + ": cut the power";
}

Result<bool> BusDriver::set(const Servo& servo, std::string_view name, int value) {
  constexpr int kTries = 2;
  for (int tries = 0; tries < kTries; ++tries) {
    if (KAZ_TRY(write(servo, name, value))) return true;
    // The answer may have been lost, or the servo answers reads alone.
    if (KAZ_TRY(read(servo, name)) == value) return true;
  }
  return false;
}

// A goal left from before would be gone to at full speed.
Result<bool> BusDriver::hold(const Servo& servo, double steps) {
  if (!KAZ_TRY(set(servo, "goal_position", static_cast<int>(std::lround(steps))))) return false;
  return set(servo, "torque_enable", 1);
}

Result<std::vector<BusDriver::Torque>> BusDriver::release(Servos servos, Time within) {
  constexpr int kRounds = 3;
  constexpr std::string_view kTorque = "torque_enable";
  std::vector<Torque> torque(servos.size(), Torque::silent);
  const Time deadline = clock_.now() + within;
  // First and to all: no servo waits for one that is silent.
  KAZ_TRY(write_all(servos, kTorque, 0));
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < servos.size(); ++i) {
      if (torque[i] == Torque::off) continue;
      if ((round > 0 || i > 0) && clock_.now() >= deadline) return torque;
      // An acknowledgement proves nothing; what is read back does.
      if (round > 0) (void)KAZ_TRY(write(*servos[i], kTorque, 0));
      const auto now = KAZ_TRY(read(*servos[i], kTorque));
      torque[i] = !now ? Torque::silent : *now == 0 ? Torque::off : Torque::on;
    }
  }
  return torque;
}

}  // namespace kaz::host
