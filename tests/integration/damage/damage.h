// Sends randomly damaged frames to the receiver and the servo tick. Measures how many pass, and their effect.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace kaz::test {

// One kind of damage. The CRC is certain to detect only the first kind.
struct Damage {
  const char* name;
  std::uint64_t frames = 0;
  std::uint64_t passed = 0;    // frames with a valid check in spite of the damage
  std::uint64_t accepted = 0;  // those of them that were valid frames
};

struct DamageReport {
  std::array<Damage, 4> kinds = {{{"one byte changed"},
                                  {"3 to 20 bytes in a row changed"},
                                  {"1 to 20 bytes lost"},
                                  {"1 to 20 bytes inserted"}}};
  std::uint64_t ticks = 0;
  std::uint64_t ticks_on = 0;          // ticks with motors on
  std::uint64_t commands_outside = 0;  // commands outside of a joint's limits
  // Maximum angle of a joint beyond its limits, 100 urad; negative if inside. Motors have no inertia.
  int furthest_outside = 0;
  double furthest_moved = 0;  // total motion of all joints, rad

  // Totals without the first kind, which must never pass.
  std::uint64_t frames() const;
  std::uint64_t passed() const;
};

// Sends `frames` damaged frames to a native board. Valid requests between them keep its joints on and moving.
DamageReport measure_damage(std::uint64_t frames, std::uint64_t seed);

}  // namespace kaz::test
