// What virtual servos have in common.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/virtual_servo.h"

#include "sim/bus/dynamixel_servo.h"
#include "sim/bus/feetech_servo.h"

namespace kaz::sim {

std::unique_ptr<VirtualServo> VirtualServo::make(const servo_bus::Model& model, int id) {
  if (model.protocol == servo_bus::Protocol::dynamixel)
    return std::make_unique<DynamixelServo>(model, id);
  return std::make_unique<FeetechServo>(model, id);
}

VirtualServo::VirtualServo(const servo_bus::Model& model, int id) : registers_(model) {
  set_up("id", id);
}

void VirtualServo::set_up(std::string_view name, int value) {
  registers_.set(name, value);
  registers_.keep(name);
}

long VirtualServo::baud() const {
  const auto code = static_cast<std::size_t>(registers_.get("baud_rate"));
  return registers_.model().bauds[code];
}

Time VirtualServo::ping_turn(int id, std::size_t answer_bits) const {
  constexpr Time kSlot = std::chrono::milliseconds(1);
  const double bits_ns = static_cast<double>(answer_bits) * 1e9 / static_cast<double>(baud());
  return id * (kSlot + Time(static_cast<std::int64_t>(bits_ns)));
}

void VirtualServo::set_power(bool on, const ServoReading& reading) {
  reading_ = reading;
  const bool starts = on && !power_;
  power_ = on;
  if (starts) restart_until(Time{});
}

void VirtualServo::restart_until(Time until) {
  registers_.power_on();
  restart();
  drop_packet();
  deaf_until_ = until;
}

MotorDrive VirtualServo::step(const ServoReading& reading, double step_s, Time now) {
  reading_ = reading;
  if (!power_ || now <= deaf_until_) return {};
  return drive(step_s, now);
}

void VirtualServo::take_noise(Time now) {
  if (!hears(now)) return;
  ++framing_errors_;
  drop_packet();
}

}  // namespace kaz::sim
