// A virtual DYNAMIXEL of the X series: protocol 2.0.
// SPDX-License-Identifier: Apache-2.0
//
// Chosen where the e-Manual says nothing: a packet with a wrong CRC that names this servo is answered with
// that error; a write that has an error anywhere changes nothing; addresses without a register among such
// with one read 0; in a sync or bulk read each servo waits for the answer of the one before it, and is silent
// without it; a broadcast ping is answered in the order of the ids, each in a time of its own; in a fast read
// those behind the first have no return delay. docs/reference/servo-bus.md has the whole list.
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
  const PacketCounts& counts() const override { return reader_.counts(); }

  // A pause longer than this between two bytes ends a packet (e-Manual).
  static constexpr Time kMaxGap = std::chrono::microseconds(1500);
  // Chosen: of a reboot, and from one id to the next in answers to a broadcast ping, besides the answer's
  // bytes.
  static constexpr Time kReboot = std::chrono::milliseconds(300);
  static constexpr Time kPingSlot = std::chrono::milliseconds(1);

 private:
  using Bytes = std::span<const std::uint8_t>;
  using Failure = dynamixel::Failure;
  struct Block {  // of registers to be read
    std::size_t address = 0, length = 0;
  };
  struct Item {  // of a write: a register, and which of a row
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
  Time started_{-1};  // of realtime_tick; -1: at the next step
  bool has_backup_ = false;
  struct RegWrite {
    std::size_t address;
    std::vector<std::uint8_t> bytes;
    bool secondary;  // it came to secondary_id
  };
  std::optional<RegWrite> reg_write_;
  // Of a group read under way: after whose answer this servo's turn is.
  struct Turn {
    std::uint8_t after;
    Block block;
  };
  std::optional<Turn> turn_;
  // Of a fast read under way: what was heard of the joined answer, how much comes before this servo's part,
  // and how much behind it.
  struct FastTurn {
    std::vector<std::uint8_t> heard;
    std::size_t before, behind;
    Block block;
  };
  std::optional<FastTurn> fast_;
  std::size_t not_mine_ = 0;  // bytes of a joined answer still to come
};

}  // namespace kaz::sim
