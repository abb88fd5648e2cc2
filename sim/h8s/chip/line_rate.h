// Computes the byte that a UART receiver decodes from a frame sent at another bit rate.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kaz::h8s {

struct HeardByte {
  bool heard = false;  // false: the start bit ended before its sample, so no byte is received
  std::uint8_t value = 0;
  bool framing_error = false;
};

// The format is 8N1. Beginning at the falling edge of the start bit, the receiver divides the time into bits
// of the length `own_bit`. The receiver samples the level in the middle of each bit. After the frame the line
// is idle (high). `sent_bit` is the bit time of the sender, and `own_bit` is the bit time of the receiver, in
// the same unit. Both bit times must be above 0. If the sender is slow, a real receiver can mistake a later
// edge of the frame for another start bit. This function does not model such start bits.
constexpr HeardByte heard_at(std::uint8_t value, std::int64_t sent_bit, std::int64_t own_bit) {
  HeardByte heard;
  const unsigned frame = 0x200u | static_cast<unsigned>(value) << 1;  // start, data, stop
  for (int k = 0; k < 10; ++k) {
    const std::int64_t sent = (2 * k + 1) * own_bit / (2 * sent_bit);
    const bool level = sent > 9 || (frame >> sent & 1) != 0;
    if (k == 0 && level) return heard;
    if (k > 0 && k < 9 && level)
      heard.value = static_cast<std::uint8_t>(heard.value | 1u << (k - 1));
    if (k == 9) heard.framing_error = !level;
  }
  heard.heard = true;
  return heard;
}

}  // namespace kaz::h8s
