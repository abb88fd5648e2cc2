// What the sources on the chip leave open or mark as unconfirmed, one named choice each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/cpu/types.h"
#include "sim/h8s/translate/available.h"

namespace kaz::h8s {

// Defaults are the best reading of the H8S/2128's siblings; README.md tells the evidence of each.
struct Options {
  Engine engine = Engine::translator;
  // How often a place is jumped to before the translator takes it on; matters for speed alone.
  std::uint32_t translate_after = 1000;
  // MD1, MD0 at reset: 2 is advanced (24-bit), 3 normal (16-bit), both single chip; 0 with P42 to P40
  // high is boot mode.
  int mode = 2;
  // A request is taken at the first instruction boundary later than this many states after it.
  int interrupt_decision_states = 3;
  // States of the exception sequence besides stacking, vector and first fetch.
  int exception_internal_states = 2;
  // CCR after reset; only bit 7 (I) is certain.
  std::uint8_t reset_ccr = 0x80;
  // RTE holds interrupts off for one instruction as LDC, ANDC, ORC and XORC do.
  bool rte_holds_off = false;
  // Bus of FRT, the 8-bit timers and the watchdogs: 16 bits wide (a word takes 2 states), else 8 (4
  // states).
  bool wide_timer_bus = true;
  // DTC: from the request to the transfer as for interrupts; states of one activation besides the
  // vector (1) and the data: accesses to the register information for each transfer, internal ones
  // once. (Other families' manuals: J = 6, M = 3.)
  int dtc_decision_states = 3;
  int dtc_register_accesses = 6;
  int dtc_internal_states = 3;
  // A/D: start delay tD of the first conversion (10..17 states at CKS=0, 6..9 at CKS=1).
  int adc_start_delay_slow = 17;
  int adc_start_delay_fast = 9;
  // After TE goes 0 to 1 one frame of mark precedes the first character.
  bool sci_preamble = true;
  // A frame begins at the next edge of the free-running bit clock; else at once. With the clock on
  // SCK it always waits, because data change at that clock's falling edge.
  bool sci_aligned_start = false;
  // Bytes that arrive by levels at RxD are there at the sample in the first stop bit; else at the
  // end of the last stop bit, as Chip::receive counts.
  bool sci_ready_mid_stop = false;
  // System clock; only the flash's pulses and waits are measured in real time.
  std::int64_t clock_hz = 18'432'000;
  // Flash pulses act by their length and waits are checked; else each pulse does all at its end.
  bool flash_timing = true;
  // Chooses the cells that a pulse moves which is too short or cut off.
  std::uint64_t flash_seed = 1;
  // PWM pulses stand at the right end of their 16-count slot.
  bool pwm_right_aligned = true;
  // The 14-bit PWM's data gives the low time of the pin for OS = 0 (the high time for OS = 1).
  bool pwmx_data_is_low = true;
  // What a read of a write-only, stopped or unmapped register gives.
  std::uint8_t undefined_read = 0xff;
  // Level of an input pin that neither the board nor a pull-up defines.
  bool floating_level = false;
  // States that a watchdog holds the chip in reset.
  int watchdog_reset_states = 518;
  // Period of the subclock on EXCL in states of the system clock; 0: none fitted.
  int subclock_states = 0;
  // STC to memory writes the register into the low byte of the word too (else 0).
  bool stc_copies = false;
  // MOV Rs,@-ERd with Rs in ERd (PUSH.W R7, PUSH.L ER7 too) stores the register as it is after the
  // decrement, else as it was before. Loads need no option: of MOV @ERs+,Rd with Rd in ERs the
  // loaded value is written last.
  bool predecrement_stores_decremented = true;
  // Boot mode. The channel that it talks on: SCI0 (P50, P51) or SCI1 (P25, P26).
  int boot_channel = 0;
  // The bit rates of the A-mask parts (19,200 to 4,800), else those of the others (9,600 to 2,400).
  bool boot_a_mask_rates = false;
  // It answers H'55 with H'AA.
  bool boot_acknowledges = true;
  // As A-mask parts do: the program has to begin with 8 bytes of identification, and starts behind them.
  bool boot_checks_id = false;
  // Two H'AA before the program starts, one behind the erase check; else one.
  bool boot_answers_twice = false;
  // The longest program that it takes.
  int boot_program_bytes = 2048;
  // For tests: erase pulses do not move the cells of this block, 0..9; -1: all are sound.
  int flash_worn_block = -1;
  // Treat each register misuse as fatal instead of counting it.
  bool stop_on_misuse = false;
};

}  // namespace kaz::h8s
