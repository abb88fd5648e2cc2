// Generates random inputs for comparing the two engines: host traffic and potentiometer voltages.
// SPDX-License-Identifier: Apache-2.0
//
// Some of the traffic is valid and some is invalid. Some joint movements are plausible and some are not. The
// seed of RandomHost determines the host traffic. The seed of RandomAnalog determines the voltages.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/base/random.hpp"
#include "shared/board/board.h"
#include "sim/mcu/mcu.h"
#include "sim/mcu/random_request.h"

namespace kaz::sim {

// Random host with phases of 50 to 1500 ms. Each phase has one of four kinds of traffic: orderly
// requests, frames without gaps, faulty frames and noise, or silence. A silence may exceed the timeout of the
// link watchdog.
class RandomHost {
 public:
  explicit RandomHost(std::uint64_t seed) : random_(seed), requests_(random_) {}
  RandomHost(const RandomHost&) = delete;
  RandomHost& operator=(const RandomHost&) = delete;
  // Returns the bytes whose transmission starts in the millisecond that begins at `now`, with the arrival
  // time of each byte. The result is empty while the line is busy with earlier bytes. Must be called once per
  // millisecond.
  std::vector<SerialByte> millisecond(States now);
  std::int64_t frames() const { return frames_; }  // number of frames sent, valid or invalid

 private:
  enum class Phase { orderly, burst, faulty, silent };

  void next_phase();
  std::vector<std::uint8_t> request();
  std::vector<std::uint8_t> any_frame();

  Random random_;
  RandomRequest requests_;
  Phase phase_ = Phase::orderly;
  int phase_left_ms_ = 300;  // the first phase is orderly, so that the host enables motors
  int pause_ms_ = 0;
  States wire_free_ = 0;
  std::uint8_t sequence_ = 0;
  std::vector<std::uint8_t> last_;  // last request, which may be repeated
  std::int64_t frames_ = 0;
};

// Random voltages at the multiplexer inputs.
class RandomAnalog {
 public:
  explicit RandomAnalog(std::uint64_t seed);
  // Advances by one millisecond. The voltages walk slowly at random. Sometimes a voltage jumps, a
  // potentiometer breaks, or the supply leaves its range.
  void millisecond();
  // Returns the voltage of an input (KZ_ANALOG_*) with noise, as a fraction of AVCC, 0..1.
  double ratio(unsigned input, States at) const;

 private:
  struct Input {
    double value = 0.5, velocity = 0;
    int broken_ms = 0;  // remaining time during which the input is at a rail
    bool high = false;
  };
  std::uint64_t seed_;
  Random random_;
  std::array<Input, KZ_ANALOG> inputs_{};
  // Remaining time during which no further input goes to a rail (0 or AVCC), so that the control loops can
  // run.
  int calm_ms_ = 2000;
};

}  // namespace kaz::sim
