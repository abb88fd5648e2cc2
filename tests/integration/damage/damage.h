// Randomly damaged frames through the receiver and the servo tick: how many pass, what they do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace kaz::test {

// One kind of damage. All but the first change more than the CRC is certain to detect.
struct Damage {
  const char* name;
  std::uint64_t frames = 0;
  std::uint64_t passed = 0;    // had the right check all the same
  std::uint64_t accepted = 0;  // of them, those that were valid frames in all respects
};

struct DamageReport {
  std::array<Damage, 4> kinds = {{{"one byte changed"},
                                  {"3 to 20 bytes in a row changed"},
                                  {"1 to 20 bytes lost"},
                                  {"1 to 20 bytes inserted"}}};
  std::uint64_t ticks = 0;
  std::uint64_t ticks_on = 0;          // with motors on
  std::uint64_t commands_outside = 0;  // commands out of a joint's limits
  int furthest_outside = 0;            // of a joint, 100 urad; motors without inertia
  double furthest_moved = 0;           // sum over all joints of what they moved, rad

  std::uint64_t frames() const;
  std::uint64_t passed() const;  // without the first kind, of which none may
};

// Sends `frames` damaged frames to a native board whose joints are on and move, with valid requests
// between them that keep it so.
DamageReport measure_damage(std::uint64_t frames, std::uint64_t seed);

}  // namespace kaz::test
