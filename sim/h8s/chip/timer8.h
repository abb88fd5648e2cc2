// Common part of the four 8-bit timers: count, compare, clear, flags and output level.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/chip/sticky.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

// Source: hardware manual, 8-bit timers. A match takes effect when the counter leaves the matching value.
// Therefore, if the match clears the counter, the period is TCOR + 1 counts.
struct Timer8 {
  // Flags in TCSR. The bits that enable their interrupts in TCR have the same positions.
  static constexpr std::uint8_t kFlags = TMR_TCSR::CMFB | TMR_TCSR::CMFA | TMR_TCSR::OVF;
  enum class Clear { none, on_a, on_b, on_pin };
  struct Crossed {
    bool a = false, b = false, overflow = false;
  };

  std::uint8_t count = 0, tcr = 0, tcora = 0xff, tcorb = 0xff;
  std::uint8_t tcsr_low = 0;  // bits 4..0 of TCSR; bits 3..0 select how matches change the output
  StickyFlags flags;          // CMFB, CMFA, OVF in bits 7..5
  States tick = 0;            // number of the clock tick at which the counter had the value `count`
  bool level = false;         // output level

  unsigned clock_select() const { return tcr & TMR_TCR::CKS; }
  Clear clear() const { return static_cast<Clear>(field<TMR_TCR::CCLR>(tcr)); }
  // Returns whether the timer drives its pin. The timer drives the pin while any OS bit is set.
  bool drives() const { return (tcsr_low & TMR_TCSR::OS) != 0; }
  // Returns whether a match toggles the output.
  bool toggles() const {
    return (tcsr_low & TMR_TCSR::OS32) == TMR_TCSR::OS32 ||
           (tcsr_low & TMR_TCSR::OS10) == TMR_TCSR::OS10;
  }
  // Returns the flags that are set and enabled as interrupts, in bits 7..5.
  unsigned requests() const { return flags.value() & tcr & kFlags; }
  // Returns the number of counts until a match or the overflow takes effect.
  std::int64_t to_next() const;
  // Advances the counter by `counts` and applies the events. `counts` must not exceed to_next().
  Crossed step(std::int64_t counts) { return step(counts, clear()); }
  Crossed step(std::int64_t counts, Clear clearing);
  // Applies matches to flags and output level.
  void matched(bool a, bool b);
  // Returns the period: the number of counts between two clears or overflows.
  std::int64_t turn() const;
  // Skips whole periods. The last period before the tick `target` is never skipped. In this last period, the
  // timer sets the same flags as in the skipped periods. If matches toggle the output, the function skips an
  // even number of periods, so that the output level stays correct.
  void skip_turns(States target);
  // Returns whether the timer counts this edge at the clock pin. The clock selection is 5 for rising edges, 6
  // for falling edges and 7 for both.
  bool counts_edge(bool rising) const {
    return clock_select() == 7 || clock_select() == (rising ? 5u : 6u);
  }
  bool waits_for_clock() const { return clock_select() > 4 && (tcr & kFlags) != 0; }
  // Returns a lower bound of the number of counts until the output level changes; kNever: counting does not
  // change the level.
  std::int64_t to_next_change() const;
  template <class A>
  void transfer(A& a) {
    a(count, tcr, tcora, tcorb, tcsr_low, flags, tick, level);
    a.require(tick >= 0, "timer");
  }
};

// Returns the output level after compare match A (`a`), compare match B (`b`) or both. If both matches occur
// at once, the effect with the highest priority applies: toggle, then 1, then 0, then no change.
bool timer_output(bool level, std::uint8_t selection, bool a, bool b);

}  // namespace kaz::h8s
