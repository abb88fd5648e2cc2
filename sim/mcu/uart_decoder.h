// Works like an 8N1 receiver: decodes the level of a serial line into bytes. For each byte, also measures how
// far the edges deviate from their nominal times.
// SPDX-License-Identifier: Apache-2.0
//
// The decoder is independent of the sending channel: the decoder's only inputs are the level changes and the
// times of these changes. Each bit is sampled in the middle of the bit time, counted from the falling edge of
// the start bit. Nominally, the time from the falling edge of the start bit to each later edge of the frame
// is a whole number of bit times.
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
  // Largest deviation of an edge of this byte from the edge's nominal time. If this byte's frame starts
  // before the nominal end of the previous frame, this value is at least the length of the overlap.
  States edge_deviation = 0;
};

class UartDecoder {
 public:
  explicit UartDecoder(States bit_states = KZ_STATES_PER_BIT) : bit_(bit_states) {}

  // Sets the line's level. The new level begins at the time `at`. Times must not decrease. If `level` is
  // equal to the line's present level, the call has no effect.
  void level(bool level, States at);
  // Advances the time to `to` without a change of level.
  void advance(States to);
  // Drops a partly received byte and sets the line's level.
  void restart(bool level);
  // Removes and returns the bytes whose stop bit has been sampled.
  std::vector<DecodedByte> take();

 private:
  States bit_;
  bool level_ = true;
  bool receiving_ = false;
  int bits_ = 0;  // sampled bits of the frame
  unsigned shift_ = 0;
  DecodedByte now_;
  std::vector<DecodedByte> decoded_;
};

}  // namespace kaz::sim
