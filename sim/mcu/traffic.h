// Random inputs for comparing the two engines: host traffic and potentiometers, from one seed.
// SPDX-License-Identifier: Apache-2.0
//
// The host sends valid and invalid traffic; the joints move plausibly and implausibly.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/base/random.hpp"
#include "shared/board/board.h"
#include "sim/mcu/mcu.h"
#include "sim/mcu/random_request.h"

namespace kaz::sim {

// Phases of 50 to 1500 ms: orderly conversation, bursts of frames back to back, faulty frames and
// noise, silence (up to longer than the firmware's link watchdog allows).
class RandomHost {
 public:
  explicit RandomHost(std::uint64_t seed) : random_(seed), requests_(random_) {}
  RandomHost(const RandomHost&) = delete;
  RandomHost& operator=(const RandomHost&) = delete;
  // Bytes whose transmission starts in the millisecond that begins at `now`, with their times of arrival.
  // None while the line is busy with earlier bytes.
  std::vector<SerialByte> millisecond(States now);
  std::int64_t frames() const { return frames_; }  // sent, valid or not

 private:
  enum class Phase { orderly, burst, faulty, silent };

  void next_phase();
  std::vector<std::uint8_t> request();
  std::vector<std::uint8_t> any_frame();

  Random random_;
  RandomRequest requests_;
  Phase phase_ = Phase::orderly;
  int phase_left_ms_ = 300;  // the first phase is orderly, so that motors get on
  int pause_ms_ = 0;
  States wire_free_ = 0;
  std::uint8_t sequence_ = 0;
  std::vector<std::uint8_t> last_;  // frame sent before: to be repeated
  std::int64_t frames_ = 0;
};

// Inputs of the multiplexers as fractions of AVCC, 0..1.
class RandomAnalog {
 public:
  explicit RandomAnalog(std::uint64_t seed);
  // One millisecond: slow walks; now and then a jump, a broken potentiometer, a supply out of
  // range.
  void millisecond();
  double ratio(unsigned input, States at) const;

 private:
  struct Input {
    double value = 0.5, velocity = 0;
    int broken_ms = 0;  // time left at a rail
    bool high = false;
  };
  std::uint64_t seed_;
  Random random_;
  std::array<Input, KZ_ANALOG> inputs_{};
  int calm_ms_ = 2000;  // nothing breaks, so that the loops run
};

}  // namespace kaz::sim
