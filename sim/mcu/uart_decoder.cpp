// Decodes 8N1 frames from the level of a serial line.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/uart_decoder.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace kaz::sim {
namespace {

constexpr int kFrameBits = 10;  // start, 8 data, stop

}  // namespace

void UartDecoder::advance(States to) {
  while (receiving_) {
    if (now_.start + bits_ * bit_ + bit_ / 2 > to) return;
    if (bits_ == 0 && level_) {  // a spike is no start bit
      receiving_ = false;
      return;
    }
    if (bits_ >= 1 && bits_ <= 8 && level_) shift_ |= 1u << (bits_ - 1);
    if (++bits_ < kFrameBits) continue;
    now_.value = static_cast<std::uint8_t>(shift_);
    now_.framing_error = !level_;
    decoded_.push_back(now_);
    receiving_ = false;
  }
}

void UartDecoder::level(bool level, States at) {
  if (level == level_) return;
  advance(at - 1);
  level_ = level;
  const States since = at - now_.start;
  if (receiving_) {
    const States to_grid = std::abs(since - (since + bit_ / 2) / bit_ * bit_);
    now_.edge_deviation = std::max(now_.edge_deviation, to_grid);
    return;
  }
  if (level) return;
  // A start bit before the end of the last frame shows that its bits were shorter.
  DecodedByte next;
  next.start = at;
  if (now_.start != 0 && since < kFrameBits * bit_) next.edge_deviation = kFrameBits * bit_ - since;
  now_ = next;
  receiving_ = true;
  bits_ = 0;
  shift_ = 0;
}

void UartDecoder::restart(bool level) {
  level_ = level;
  receiving_ = false;
  now_ = {};
}

std::vector<DecodedByte> UartDecoder::take() {
  return std::exchange(decoded_, {});
}

}  // namespace kaz::sim
