// A virtual servo on a bus: bytes in, answers out, and the drive of its motor.
// SPDX-License-Identifier: Apache-2.0
//
// Virtual servos follow the published protocols and register tables (docs/reference/servo-bus.md), not the
// makers' firmware, which is closed. feetech_servo.h and dynamixel_servo.h say what was chosen where these
// say nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "shared/base/packet_counts.hpp"
#include "shared/base/time.hpp"
#include "shared/servo_bus/registers.h"
#include "sim/body/motor/motor_drive.h"
#include "sim/bus/register_file.h"
#include "sim/bus/servo_reading.h"

namespace kaz::sim {

class VirtualServo {
 public:
  virtual ~VirtualServo() = default;
  // Of the model's protocol.
  static std::unique_ptr<VirtualServo> make(const servo_bus::Model& model, int id);

  struct Answer {
    std::vector<std::uint8_t> bytes;
    Time delay{};  // from the end of the byte that led to it
  };
  // A byte that has come at `now`, the end of its stop bit. An answer, if one is due, is sent at the rate
  // before the request; afterwards baud() holds.
  virtual std::optional<Answer> take(std::uint8_t byte, Time now) = 0;
  // A byte without a stop bit.
  void take_noise(Time now);
  long baud() const;

  void set_power(bool on, const ServoReading& reading);
  bool power() const { return power_; }
  // One step of the world, which ends at `now`.
  MotorDrive step(const ServoReading& reading, double step_s, Time now);

  // Writes a register as whoever sets the servo up: kept without power.
  void set_up(std::string_view name, int value);
  RegisterFile& registers() { return registers_; }
  const RegisterFile& registers() const { return registers_; }
  virtual const PacketCounts& counts() const = 0;
  std::uint64_t framing_errors() const { return framing_errors_; }
  // Requests to this servo, broadcasts included.
  std::uint64_t executed() const { return executed_; }

 protected:
  VirtualServo(const servo_bus::Model& model, int id);
  // As after power-on.
  virtual void restart() = 0;
  virtual MotorDrive drive(double step_s, Time now) = 0;
  virtual void drop_packet() = 0;
  // Restarts; deaf for so long.
  void restart_until(Time until);
  bool hears(Time now) const { return power_ && now >= deaf_until_; }

  RegisterFile registers_;
  ServoReading reading_;
  Time last_byte_{};
  std::uint64_t executed_ = 0;

 private:
  Time deaf_until_{};
  bool power_ = true;
  std::uint64_t framing_errors_ = 0;
};

}  // namespace kaz::sim
