// A virtual servo of Feetech's: bytes in, answers out, and the drive of its motor.
// SPDX-License-Identifier: Apache-2.0
//
// Follows the published protocol and register tables (docs/reference/servo-bus.md), not the maker's firmware,
// which is closed. Chosen where these say nothing: a request with an unknown instruction, or one that this
// model does not have, is not answered; values written are limited to the register's range; writes to
// read-only registers are answered and change nothing; addresses without a register read 0; in a sync read
// each servo waits for the answer of the one before it in the list, as protocol 1.0 says of a bulk read.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/base/time.hpp"
#include "shared/feetech/packet.h"
#include "shared/feetech/registers.h"
#include "sim/body/motor/motor_drive.h"
#include "sim/bus/register_file.h"
#include "sim/bus/servo_motion.h"
#include "sim/bus/servo_protection.h"

namespace kaz::sim {

class VirtualServo {
 public:
  VirtualServo(const feetech::Model& model, int id);

  struct Answer {
    std::vector<std::uint8_t> bytes;
    Time delay{};  // from the end of the request's last byte
  };
  // A byte that has come at `now`, the end of its stop bit. An answer, if one is due, is sent at the rate
  // before the request; afterwards baud() holds.
  std::optional<Answer> take(std::uint8_t byte, Time now);
  // A byte without a stop bit.
  void take_noise(Time now);
  long baud() const;

  void set_power(bool on, const ServoReading& reading);
  bool power() const { return power_; }
  // One step of the world, which ends at `now`.
  MotorDrive step(const ServoReading& reading, double step_s, Time now);

  RegisterFile& registers() { return registers_; }
  const RegisterFile& registers() const { return registers_; }
  const feetech::PacketReader::Counts& counts() const { return reader_.counts(); }
  std::uint64_t framing_errors() const { return framing_errors_; }
  std::uint64_t executed() const {
    return executed_;
  }  // requests to this servo, broadcasts included

  // A pause this long between two bytes ends a packet (protocol 1.0), and that of a restart (manual: about).
  static constexpr Time kMaxGap = std::chrono::milliseconds(100);
  static constexpr Time kRestart = std::chrono::milliseconds(800);

 private:
  using Bytes = std::span<const std::uint8_t>;
  std::optional<Answer> execute(const feetech::Packet& packet, Time now);
  std::optional<Answer> answer(std::vector<std::uint8_t> parameters = {}) const;
  std::optional<Answer> sync_read(Bytes parameters);
  void sync_write(Bytes parameters);
  void write(std::uint8_t address, Bytes bytes);
  void restart();

  RegisterFile registers_;
  ServoMotion motion_;
  ServoProtection protection_;
  ServoReading reading_;
  feetech::PacketReader reader_;
  Time last_byte_{}, deaf_until_{};
  bool power_ = true;
  std::uint64_t framing_errors_ = 0, executed_ = 0;
  struct RegWrite {
    std::uint8_t address;
    std::vector<std::uint8_t> bytes;
  };
  std::optional<RegWrite> reg_write_;
  // Of a sync read under way: after whose answer this servo's turn is, and what is read.
  struct Turn {
    std::uint8_t after, address, length;
  };
  std::optional<Turn> turn_;
};

}  // namespace kaz::sim
