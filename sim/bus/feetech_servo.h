// Virtual Feetech servo: receives bytes, returns answers and drives its motor.
// SPDX-License-Identifier: Apache-2.0
//
// The virtual servo follows the published protocol and register tables (docs/reference/servo-bus.md), because
// the maker's firmware is closed. Where the protocol and the tables do not define the behavior, we chose the
// following:
// - Unknown instructions, and instructions that the model does not support, are not answered.
// - Written values are clamped to the register's range.
// - Writes to read-only registers are answered and change nothing.
// - If a read covers an address without a register, the answer contains 0 for this address.
// - In a sync read, each servo waits until the previous servo has answered, like in a bulk read of protocol
//   1.0.
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
  void use_law(IdentifiedLaw::Params params) override { motion_.use_law(std::move(params)); }
  const PacketCounts& counts() const override { return reader_.counts(); }

  // Maximum gap between two bytes of a packet. A longer gap ends the packet (protocol 1.0).
  static constexpr Time kMaxGap = std::chrono::milliseconds(100);
  // Duration of a restart. The manual states only an approximate value.
  static constexpr Time kRestart = std::chrono::milliseconds(800);

 private:
  using Bytes = std::span<const std::uint8_t>;
  std::optional<Answer> execute(const feetech::Packet& packet, Time now);
  std::optional<Answer> answer(std::vector<std::uint8_t> parameters = {}) const;
  std::optional<Answer> sync_read(Bytes parameters);
  void sync_write(Bytes parameters);
  void write(std::uint8_t address, Bytes bytes);
  std::optional<Answer> ping(bool broadcast) const;
  // Returns whether the register `phase` of an STS servo has this bit. The bits of SCS servos are unknown.
  bool phase_has(int bit) const;
  // Returns reading_ as the position loop receives it: reversed if `phase` reverses the feedback.
  ServoReading sensed() const;
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
  // This servo's part of a sync read. This servo answers after the servo with the id `after` has answered.
  struct Turn {
    std::uint8_t after, address, length;
  };
  std::optional<Turn> turn_;
};

}  // namespace kaz::sim
