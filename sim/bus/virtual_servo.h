// A virtual servo on a bus: receives bytes, returns answers and drives its motor.
// SPDX-License-Identifier: Apache-2.0
//
// Virtual servos follow the published protocols and register tables (docs/reference/servo-bus.md), because
// the makers' firmware is closed. Protocols and tables do not define all behavior. feetech_servo.h and
// dynamixel_servo.h list our choices.
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
#include "sim/bus/identified_law.h"
#include "sim/bus/register_file.h"
#include "sim/bus/servo_reading.h"

namespace kaz::sim {

class VirtualServo {
 public:
  virtual ~VirtualServo() = default;
  // Creates a servo that uses the protocol of `model`. `model` must outlive the servo.
  static std::unique_ptr<VirtualServo> make(const servo_bus::Model& model, int id);

  struct Answer {
    std::vector<std::uint8_t> bytes;
    // Time from the end of the byte that caused the answer to the start of the answer.
    Time delay{};
  };
  // Processes a byte whose stop bit ended at `now`. Returns an answer if the servo must send an answer now.
  // If the byte changes the baud rate of the servo, the caller must send the answer at the rate that baud()
  // returned before take(). After the answer, the servo uses the new rate.
  virtual std::optional<Answer> take(std::uint8_t byte, Time now) = 0;
  // Processes a byte with a framing error.
  void take_noise(Time now);
  long baud() const;

  void set_power(bool on, const ServoReading& reading);
  bool power() const { return power_; }
  // Uses the control law of an identified servo in the position modes. The torque switch is then late, too.
  virtual void use_law(IdentifiedLaw::Params params) = 0;
  // Advances by one step of the world. The step ends at `now`. Returns the drive of the motor for this step.
  MotorDrive step(const ServoReading& reading, double step_s, Time now);

  // Sets how a Feetech servo answers a broadcast ping: at once, or in the order of the ids. DYNAMIXEL servos
  // always answer in the order of the ids.
  void answer_broadcast_ping_in_turn(bool in_turn) { broadcast_ping_in_turn_ = in_turn; }
  // Writes a register permanently, as a user does when setting up the servo for a robot.
  void set_up(std::string_view name, int value);
  RegisterFile& registers() { return registers_; }
  const RegisterFile& registers() const { return registers_; }
  virtual const PacketCounts& counts() const = 0;
  std::uint64_t framing_errors() const { return framing_errors_; }
  // Returns the number of executed requests to this servo, including broadcasts.
  std::uint64_t executed() const { return executed_; }

 protected:
  VirtualServo(const servo_bus::Model& model, int id);
  // Sets the state after power-on. Precondition: registers_ is already reset.
  virtual void restart() = 0;
  virtual MotorDrive drive(double step_s, Time now) = 0;
  virtual void drop_packet() = 0;  // discards a partial packet
  // Restarts the servo. The servo ignores the bus until `until`.
  void restart_until(Time until);
  bool hears(Time now) const { return power_ && now >= deaf_until_; }
  // Returns the additional delay of the answer to a broadcast ping if servos answer in the order of their
  // ids. Each id has a time slot of 1 ms (chosen by us) plus the duration of `answer_bits`.
  Time ping_turn(int id, std::size_t answer_bits) const;

  RegisterFile registers_;
  ServoReading reading_;
  Time last_byte_{};
  std::uint64_t executed_ = 0;
  bool broadcast_ping_in_turn_ = false;

 private:
  Time deaf_until_{};
  bool power_ = true;
  std::uint64_t framing_errors_ = 0;
};

}  // namespace kaz::sim
