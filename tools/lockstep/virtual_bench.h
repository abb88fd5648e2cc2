// A virtual servo board on a test bench, in simulated time, for tests of the board alone.
// SPDX-License-Identifier: Apache-2.0
//
// The bench has no robot: each joint is a motor that turns freely. The motor's speed follows its drive with a
// first-order lag. This simple model makes the bench fast. Tests can disturb every input of the board.
// Waiting advances time in steps of 1/8 ms.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "hil/conformance/bench.h"
#include "host/link/link.h"
#include "sim/mcu/mcu.h"
#include "sim/runtime/simulation/serial_line.h"

namespace kaz::lockstep {

class VirtualBench final : public hil::Bench, public host::Link, public host::Clock {
 public:
  explicit VirtualBench(std::unique_ptr<sim::Mcu> mcu);

  // host::Clock
  Time now() const override;
  Result<void> sleep_until(Time t) override;
  // host::Link
  std::string name() const override;
  Time byte_time() const override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  // hil::Bench
  void restore() override;
  void reset() override { mcu_->reset(); }
  void set_power(bool on) override;
  void set_analog(int input, std::optional<int> code) override;
  void place_joint(int joint, double angle_rad) override;
  void block_joint(int joint, bool blocked) override;
  void write_damaged(std::span<const std::uint8_t> bytes) override;
  double drive(int joint) const override;
  double angle_rad(int joint) const override;

 private:
  struct Joint {
    double angle = 0, speed = 0;  // rad, rad/s
    bool blocked = false;
  };
  Result<void> step();
  double share(int channel, const sim::PinLevels& levels) const;

  std::unique_ptr<sim::Mcu> mcu_;
  sim::SerialLine line_;
  sim::States now_ = 0;
  sim::States off_ = 0;  // total time without power
  bool power_ = true;
  std::array<Joint, KZ_JOINTS> joints_{};
  std::array<std::optional<int>, KZ_ANALOG> held_{};  // A/D codes that set_analog() has set
};

}  // namespace kaz::lockstep
