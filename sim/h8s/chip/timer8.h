// Common parts of the four 8-bit timers: count, compare, clear, flags and output level.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

// Hardware manual, 8-bit timers. A match takes effect when the counter leaves the value it matched,
// so a clear on match gives periods of TCOR + 1 counts.
struct Timer8 {
  static constexpr std::uint8_t kOvf = 0x20, kCmfa = 0x40, kCmfb = 0x80;
  enum class Clear { none, on_a, on_b, on_pin };
  struct Crossed {
    bool a = false, b = false, overflow = false;
  };

  std::uint8_t count = 0, tcr = 0, tcora = 0xff, tcorb = 0xff;
  std::uint8_t tcsr_low = 0;  // bits 4..0 of TCSR; 3..0 select the effect of matches on the output
  StickyFlags flags;          // CMFB, CMFA, OVF in bits 7..5
  States tick = 0;            // clock ticks up to which `count` is right
  bool level = false;

  unsigned clock_select() const { return tcr & 7u; }
  Clear clear() const { return static_cast<Clear>(tcr >> 3 & 3); }
  // Whether the timer owns its pin: any output selection is made.
  bool drives() const { return (tcsr_low & 0x0f) != 0; }
  // Flags that are set and enabled; `enables` has the flags' bit positions.
  unsigned requests() const { return flags.value() & tcr & 0xe0u; }
  // Counts until a match or the overflow takes effect.
  std::int64_t to_next() const;
  // `counts` is at most to_next().
  Crossed step(std::int64_t counts) { return step(counts, clear()); }
  Crossed step(std::int64_t counts, Clear clearing);
  // Applies matches to flags and output level.
  void matched(bool a, bool b);
  // Counts between two clears.
  std::int64_t turn() const;
  // Skips whole periods up to `target` that change nothing: every possible flag is set, and a toggled
  // output repeats after two periods, any other after one.
  void skip_turns(States target);
  // An edge at the clock pin counts for clock selections 5 (rising), 6 (falling) and 7 (both).
  bool counts_edge(bool rising) const {
    return clock_select() == 7 || clock_select() == (rising ? 5u : 6u);
  }
  bool waits_for_clock() const { return clock_select() > 4 && (tcr & 0xe0) != 0; }
  // Lower bound on the counts until the output level changes; kNever: counting does not change it.
  std::int64_t to_next_change() const;
  template <class A>
  void transfer(A& a) {
    a(count, tcr, tcora, tcorb, tcsr_low, flags, tick, level);
    a.require(tick >= 0, "timer");
  }
};

// Output level after matches. If both occur at once, toggle has priority over 1 over 0 over none.
bool timer_output(bool level, std::uint8_t selection, bool a, bool b);

}  // namespace kaz::h8s
