// Virtual DYNAMIXEL of the X series (protocol 2.0): receives bytes, returns answers and drives its motor.
// SPDX-License-Identifier: Apache-2.0
//
// The e-Manual does not define all behavior. docs/reference/servo-bus.md lists all our choices. The main
// choices:
//
// - If a packet to this servo has a wrong CRC, the servo answers with the CRC error.
// - If a write has any error, no register is changed.
// - If a read covers at least one register, the answer contains 0 for each address without a register.
// - In a sync or bulk read, each servo waits until the previous servo has answered. If the previous servo
//   does not answer, the waiting servo does not answer either.
// - A broadcast ping is answered in the order of the ids. Each servo answers in a separate time slot.
// - In a fast read, only the first servo waits for its return delay before it answers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/dynamixel/packet.h"
#include "sim/bus/dynamixel_motion.h"
#include "sim/bus/dynamixel_protection.h"
#include "sim/bus/virtual_servo.h"

namespace kaz::sim {

class DynamixelServo final : public VirtualServo {
 public:
  DynamixelServo(const servo_bus::Model& model, int id) : VirtualServo(model, id) {}

  std::optional<Answer> take(std::uint8_t byte, Time now) override;
  void use_law(IdentifiedLaw::Params params) override { motion_.use_law(std::move(params)); }
  const PacketCounts& counts() const override { return reader_.counts(); }

  // Maximum gap between two bytes of a packet. A longer gap ends the packet (e-Manual).
  static constexpr Time kMaxGap = std::chrono::microseconds(1500);
  // Duration of a reboot (chosen by us).
  static constexpr Time kReboot = std::chrono::milliseconds(300);

 private:
  using Bytes = std::span<const std::uint8_t>;
  using Failure = dynamixel::Failure;
  struct Block {  // addresses to be read
    std::size_t address = 0, length = 0;
  };
  struct Item {  // value to write; `index` selects one of the registers that `reg` describes
    const servo_bus::Register* reg;
    int index, value;
  };

  std::optional<Answer> execute(const dynamixel::Packet& packet, Time now);
  std::optional<Answer> status(Failure failure, std::vector<std::uint8_t> parameters = {}) const;
  std::uint8_t error_byte(Failure failure) const;
  Time return_delay() const;
  bool answers_reads() const { return registers_.get("status_return_level") >= 1; }
  std::optional<Answer> ping(bool broadcast) const;
  std::optional<Answer> read(Block block) const;
  std::optional<Answer> group_read(Bytes parameters, bool bulk);
  std::optional<Answer> fast_read(Bytes parameters, bool bulk);
  std::optional<Answer> continue_fast(std::uint8_t byte);
  void group_write(Bytes parameters, bool bulk);
  Failure action();
  Failure reset_to_factory(Bytes parameters, bool broadcast, Time now);
  Failure clear(Bytes parameters);
  Failure keep_or_restore(Bytes parameters, Time now);

  std::size_t target_of(std::size_t address) const;
  std::vector<std::uint8_t> bytes_at(Block block) const;
  Failure items_of(std::size_t address, Bytes bytes, std::vector<Item>& items) const;
  Failure refuses(const Item& item) const;
  Failure write(std::size_t address, Bytes bytes, bool secondary = false);
  void apply(const Item& item);
  void switch_on();

  void restart() override;
  MotorDrive drive(double step_s, Time now) override;
  void drop_packet() override;
  bool watchdog_tripped() const { return registers_.get("bus_watchdog") < 0; }

  DynamixelMotion motion_;
  DynamixelProtection protection_;
  dynamixel::PacketReader reader_;
  Time last_request_{};
  Time started_{-1};  // time at which realtime_tick was 0; -1: the next step sets this time
  bool has_backup_ = false;
  struct RegWrite {
    std::size_t address;
    std::vector<std::uint8_t> bytes;
    bool secondary;  // true if the packet was sent to secondary_id
  };
  std::optional<RegWrite> reg_write_;
  // This servo's part of a sync or bulk read. This servo answers after the servo with the id `after` has
  // answered.
  struct Turn {
    std::uint8_t after;
    Block block;
  };
  std::optional<Turn> turn_;
  // This servo's part of a fast read, in which several servos send one common answer. `heard` contains the
  // bytes of the common answer that this servo has received so far. `before` and `behind` are the numbers of
  // bytes that other servos send before and after this servo's part.
  struct FastTurn {
    std::vector<std::uint8_t> heard;
    std::size_t before, behind;
    Block block;
  };
  std::optional<FastTurn> fast_;
  // Number of bytes that this servo still has to ignore. Other servos send these bytes after this servo's
  // part of a common answer.
  std::size_t not_mine_ = 0;
};

}  // namespace kaz::sim
