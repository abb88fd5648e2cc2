// For tests: runs the real servo code with a simulated serial line, clock and motors, in one thread.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/link/link.h"
#include "shared/board/board.h"
#include "shared/servo/servo.h"
#include "shared/servo/tick.h"

namespace kaz::host {

// A clock, a link and a board. Simulated time advances only while a caller waits.
// Motors are first-order systems: a linear speed-torque curve, Coulomb friction, and the inertia of rotor and
// head.
class TestBoard final : public Clock, public Link {
 public:
  using Angles = std::array<double, KZ_JOINTS>;  // rad

  struct Options {
    Time tick_offset = std::chrono::microseconds(123456);  // host time of tick 0
    double crystal_ppm = 0;  // amount by which the board's millisecond is too long, ppm
    // Largest delay added to a chunk of bytes. The delays are uniformly distributed from 0 to this value.
    // `seed` is the seed of their random numbers.
    Time latency_to_board{}, latency_to_host{};
    std::uint64_t seed = 1;
    bool state_byte_time = true;  // false: byte_time() returns 0 (unknown)
  };
  TestBoard() : TestBoard(Options{}) {}
  explicit TestBoard(const Options& options);

  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override;
  std::string name() const override { return "test-port"; }
  Time byte_time() const override { return options_.state_byte_time ? kByte : Time::zero(); }
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;

  // True host time at which a tick started. Ticks are counted from the first start, across reset().
  Time start_of_tick(std::uint32_t tick) const;
  // Simulates a power cycle: motors off, ticks from 0, bytes in transit lost.
  void reset();
  std::uint32_t board_tick() const { return next_tick_ - reset_at_; }
  // True joint angles (rad) at `t`, which must not be later than now(). Interpolates between ticks.
  Angles angles_at(Time t) const;
  void set_angle(int joint, double rad) { angle_[static_cast<std::size_t>(joint)] = rad; }
  bool motors_on() const { return motors_on_; }

  // Appends bytes that the next read returns at once.
  void inject(std::span<const std::uint8_t> bytes);

  using Bytes = std::vector<std::uint8_t>;
  // If set, to_board filters each write to the board, and to_host filters each complete frame from the board.
  std::function<Bytes(Bytes)> to_board, to_host;
  // If set, called after each tick with the tick's start time.
  std::function<void(Time)> after_tick;
  bool mute = false;                   // true: the board behaves as if it were off
  std::optional<Error> link_failure;   // if set, read and write return this error
  std::optional<double> supply_volts;  // supply voltage; empty: 10 V
  // Converter codes of the yaw rate and of the accelerations forward and left; 0: sensor not fitted.
  std::array<std::uint16_t, 3> inertial{};

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
  std::vector<Angles> past_;  // past joint angles, indexed by tick
  std::deque<TimedByte> to_board_, to_host_;
  Time line_to_board_free_{}, line_to_host_free_{};
  Bytes frame_from_board_;
};

}  // namespace kaz::host
