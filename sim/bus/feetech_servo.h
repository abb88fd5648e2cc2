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

#include "shared/feetech/packet.h"
#include "sim/bus/feetech_motion.h"
#include "sim/bus/feetech_protection.h"
#include "sim/bus/virtual_servo.h"

namespace kaz::sim {

class FeetechServo final : public VirtualServo {
 public:
  FeetechServo(const servo_bus::Model& model, int id) : VirtualServo(model, id) {}

  std::optional<Answer> take(std::uint8_t byte, Time now) override;
  const PacketCounts& counts() const override { return reader_.counts(); }

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
  void restart() override;
  MotorDrive drive(double step_s, Time now) override;
  void drop_packet() override { reader_.reset(); }

  FeetechMotion motion_;
  FeetechProtection protection_;
  feetech::PacketReader reader_;
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
