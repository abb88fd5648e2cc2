// Virtual DYNAMIXEL of the X series (protocol 2.0): receives bytes, returns answers and drives its motor.
// SPDX-License-Identifier: Apache-2.0
//
// The e-Manual leaves some behavior open. docs/reference/servo-bus.md lists all our choices. The main ones:
//
// - A packet to this servo with a wrong CRC is answered with that error.
// - A write with any error changes nothing.
// - Addresses without a register read 0 if others in the same read have one.
// - In a sync or bulk read each servo waits for its predecessor's answer, and stays silent without it.
// - A broadcast ping is answered in the order of the ids, each in its own time slot.
// - In a fast read only the first servo has a return delay.
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

  // A longer gap between two bytes ends a packet (e-Manual).
  static constexpr Time kMaxGap = std::chrono::microseconds(1500);
  // Chosen: duration of a reboot.
  static constexpr Time kReboot = std::chrono::milliseconds(300);
  // Chosen: time from one id to the next in answers to a broadcast ping, in addition to the answer's bytes.
  static constexpr Time kPingSlot = std::chrono::milliseconds(1);

 private:
  using Bytes = std::span<const std::uint8_t>;
  using Failure = dynamixel::Failure;
  struct Block {  // addresses to be read
    std::size_t address = 0, length = 0;
  };
  struct Item {  // one register of a write, and its index in a row
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
  Time started_{-1};  // time 0 of realtime_tick; -1: set by the next step
  bool has_backup_ = false;
  struct RegWrite {
    std::size_t address;
    std::vector<std::uint8_t> bytes;
    bool secondary;  // sent to secondary_id
  };
  std::optional<RegWrite> reg_write_;
  // This servo's part of a sync or bulk read: it answers after the servo with the id `after`.
  struct Turn {
    std::uint8_t after;
    Block block;
  };
  std::optional<Turn> turn_;
  // This servo's part of a fast read. `heard`: bytes of the common answer so far. `before`, `behind`: number
  // of its bytes on either side of this servo's part.
  struct FastTurn {
    std::vector<std::uint8_t> heard;
    std::size_t before, behind;
    Block block;
  };
  std::optional<FastTurn> fast_;
  std::size_t not_mine_ = 0;  // remaining bytes of a common answer, to be ignored
};

}  // namespace kaz::sim
