// Decodes the level of a serial line as an 8N1 receiver, and measures its edges.
// SPDX-License-Identifier: Apache-2.0
//
// Independent of the sending channel: its only input are level changes with their times. Each bit
// is sampled in its middle, counted from the falling edge of the start bit. The edges of a frame should
// be at whole bit times; the largest deviation is reported.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/board/board.h"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

struct DecodedByte {
  std::uint8_t value = 0;
  States start = 0;            // falling edge of the start bit
  bool framing_error = false;  // the stop bit is low
  States edge_deviation = 0;   // of its edges, and of the next start bit if that comes too early
};

class UartDecoder {
 public:
  explicit UartDecoder(States bit_states = KZ_STATES_PER_BIT) : bit_(bit_states) {}

  // The line has `level` from `at` on. Times must not decrease. A level that stays is no edge.
  void level(bool level, States at);
  // Advances the time to `to` without a change of level.
  void advance(States to);
  // Drops a byte in progress; the line has `level`.
  void restart(bool level);
  // Bytes whose stop bit has been sampled.
  std::vector<DecodedByte> take();

 private:
  States bit_;
  bool level_ = true;
  bool receiving_ = false;
  int bits_ = 0;  // sampled of the frame
  unsigned shift_ = 0;
  DecodedByte now_;
  std::vector<DecodedByte> decoded_;
};

}  // namespace kaz::sim
