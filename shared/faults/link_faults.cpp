// Line faults on bytes: drop, flip, duplicate, insert, delay, baud error.
// SPDX-License-Identifier: Apache-2.0
#include "shared/faults/link_faults.h"

#include <algorithm>

namespace kaz::faults {

LineByte sampled(std::uint8_t value, double error) {
  // Bits on the line from the start bit: 0, data (lowest first), 1, and idle.
  const auto level = [value](int bit) {
    if (bit == 0) return 0;
    return bit <= 8 ? value >> (bit - 1) & 1 : 1;
  };
  LineByte got;
  for (int i = 0; i < 8; ++i) {
    got.value |= static_cast<std::uint8_t>(level(static_cast<int>((1.5 + i) * (1.0 + error))) << i);
  }
  got.framing_error = level(static_cast<int>(9.5 * (1.0 + error))) == 0;
  return got;
}

LineBytes LinkFaults::pass(const Schedule& schedule, Time t, LineByte byte) {
  LineBytes out;
  bool lost = false, twice = false, noise = false;
  for (const Fault& fault : schedule.faults()) {
    if (kind_of(fault.name).target != Target::line || !fault.active(t)) continue;
    if (fault.way != Way::both && fault.way != way_) continue;
    switch (fault.name) {
      case Name::link_drop:
        lost |= random_.chance(fault.value);
        break;
      case Name::link_flip:
        if (random_.chance(fault.value))
          byte.value = static_cast<std::uint8_t>(byte.value ^ (1u << random_.below(8)));
        break;
      case Name::link_duplicate:
        twice |= random_.chance(fault.value);
        break;
      case Name::link_insert:
        noise |= random_.chance(fault.value);
        break;
      case Name::link_delay:
        out.delay += Time(static_cast<std::int64_t>(fault.value * 1e9));
        break;
      case Name::link_baud: {
        const LineByte got = sampled(byte.value, fault.value);
        byte = {got.value, byte.framing_error || got.framing_error};
        break;
      }
      case Name::link_cut:
        return {};
      default:
        break;
    }
  }
  if (noise) out.bytes[out.count++] = {static_cast<std::uint8_t>(random_.below(256)), false};
  if (!lost) {
    out.bytes[out.count++] = byte;
    if (twice) out.bytes[out.count++] = byte;
  }
  return out;
}

}  // namespace kaz::faults
