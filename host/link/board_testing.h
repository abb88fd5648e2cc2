// For tests: the real servo code behind a simulated serial line, clock and motors, in one thread.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "host/link/link.h"
#include "shared/board/board.h"
#include "shared/servo/servo.h"
#include "shared/servo/tick.h"

namespace kaz::host {

// A clock, a link and a board. Time passes when somebody waits. Motors are first-order: speed
// follows duty by the motor's line, with Coulomb friction (design, section 4) and the inertia of
// rotor and head.
class TestBoard final : public Clock, public Link {
 public:
  using Angles = std::array<double, KZ_JOINTS>;  // rad

  struct Options {
    Time tick_offset = std::chrono::microseconds(123456);  // host time of tick 0
    double crystal_ppm = 0;                                // board's millisecond longer by this
    // Delay added to each chunk of bytes, uniform in 0..this, from a generator seeded with `seed`.
    Time latency_to_board{}, latency_to_host{};
    std::uint64_t seed = 1;
    bool state_byte_time = true;  // byte_time() is known
  };
  TestBoard() : TestBoard(Options{}) {}
  explicit TestBoard(const Options& options);

  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override;
  std::string name() const override { return "test-port"; }
  Time byte_time() const override { return options_.state_byte_time ? kByte : Time::zero(); }
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;

  // True host time at which a tick started; ticks are counted from the first start, across reset().
  Time start_of_tick(std::uint32_t tick) const;
  // Power cycle: motors off, ticks from 0, bytes in transit are lost.
  void reset();
  std::uint32_t board_tick() const { return next_tick_ - reset_at_; }
  // True joint angles (rad) at a time not later than now, interpolated between ticks.
  Angles angles_at(Time t) const;
  void set_angle(int joint, double rad) { angle_[static_cast<std::size_t>(joint)] = rad; }
  bool motors_on() const { return motors_on_; }

  // Bytes that the next read returns at once.
  void inject(std::span<const std::uint8_t> bytes);

  using Bytes = std::vector<std::uint8_t>;
  // If set, each write to the board, and each whole frame from it, passes through these.
  std::function<Bytes(Bytes)> to_board, to_host;
  // If set, called after each tick with its start.
  std::function<void(Time)> after_tick;
  bool mute = false;                        // the board is off
  std::optional<Error> link_failure;        // what reads and writes return from now on
  std::optional<double> supply_volts;       // instead of 10 V
  std::array<std::uint16_t, 3> inertial{};  // codes of yaw rate, forward and left; 0: not fitted

 private:
  static constexpr Time kByte = std::chrono::nanoseconds(86805);
  struct TimedByte {
    Time at{};
    std::uint8_t value = 0;
  };
  void run_until(Time t);
  void run_tick(Time start);
  void transmit(Time start);
  void move_joints();
  std::uint16_t pot_code(std::size_t joint) const;
  Time random_delay(Time max_delay);

  Options options_;
  Time now_{};
  std::uint64_t random_;
  std::unique_ptr<kz_servo> servo_;
  kz_tick_output output_{};
  std::uint32_t next_tick_ = 0, reset_at_ = 0;
  bool motors_on_ = false;
  Angles angle_{}, speed_{};
  std::vector<Angles> past_;  // by tick
  std::deque<TimedByte> to_board_, to_host_;
  Time line_to_board_free_{}, line_to_host_free_{};
  Bytes frame_from_board_;
};

}  // namespace kaz::host
