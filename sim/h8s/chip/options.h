// Options: one for each property of the chip that the available sources leave open.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/cpu/types.h"
#include "sim/h8s/translate/available.h"

namespace kaz::h8s {

// Defaults follow the manuals of the H8S/2128's siblings. Evidence: sim/h8s/README.md,
// docs/explanation/emulator.md.
struct Options {
  Engine engine = Engine::translator;
  // Number of jumps to an address before its code is translated; affects speed only.
  std::uint32_t translate_after = 100;
  // MD1, MD0 at reset: 2 is advanced (24-bit), 3 normal (16-bit), both single chip; 0 with P42 to P40
  // high is boot mode.
  int mode = 2;
  // An interrupt is accepted at the first instruction boundary more than this many states after the
  // request (hardware manual, interrupt response times).
  int interrupt_decision_states = 3;
  // States of the exception sequence besides stacking, vector and first fetch.
  int exception_internal_states = 2;
  // CCR after reset; only bit 7 (I) is certain.
  std::uint8_t reset_ccr = 0x80;
  // RTE holds interrupts off for one instruction as LDC, ANDC, ORC and XORC do.
  bool rte_holds_off = false;
  // The bus of FRT, the 8-bit timers and the watchdogs is 16 bits wide (2 states per word), else 8 bits
  // (4 states).
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
  // A frame begins at the next edge of the free-running bit clock, else immediately. With the clock on
  // SCK it always waits, because data change at that clock's falling edge.
  bool sci_aligned_start = false;
  // Bytes received as levels at RxD become available at the sample of the first stop bit, else at the
  // end of the last stop bit, as with Chip::receive.
  bool sci_ready_mid_stop = false;
  // System clock, Hz. Used only for the flash's pulses and waits, which are specified in microseconds.
  std::int64_t clock_hz = 18'432'000;
  // Flash pulses take effect according to their length, and waits are checked; else each pulse takes full
  // effect at its end.
  bool flash_timing = true;
  // Seed that selects the cells changed by a pulse that is too short or cut off.
  std::uint64_t flash_seed = 1;
  // PWM pulses are at the end of their 16-count slot, else at its beginning.
  bool pwm_right_aligned = true;
  // The 14-bit PWM's data is the low time of the pin for OS = 0 (the high time for OS = 1).
  bool pwmx_data_is_low = true;
  // Value read from a write-only, stopped or unmapped register.
  std::uint8_t undefined_read = 0xff;
  // Level of an input pin that neither the board nor a pull-up defines.
  bool floating_level = false;
  // Duration of a watchdog reset, states.
  int watchdog_reset_states = 518;
  // Period of the subclock on EXCL, in states of the system clock; 0: no subclock.
  int subclock_states = 0;
  // STC to memory writes the register into the low byte of the word too (else 0).
  bool stc_copies = false;
  // MOV Rs,@-ERd with Rs part of ERd (also PUSH.W R7, PUSH.L ER7) stores the register's value after the
  // decrement, else before. MOV @ERs+,Rd with Rd part of ERs is not ambiguous: the loaded value is written
  // last.
  bool predecrement_stores_decremented = true;
  // Boot mode: the serial channel, SCI0 (P50, P51) or SCI1 (P25, P26).
  int boot_channel = 0;
  // Boot mode: bit rates of the A-mask parts (19,200 to 4,800 bit/s), else of the others (9,600 to 2,400).
  bool boot_a_mask_rates = false;
  // Boot mode: H'55 is acknowledged with H'AA.
  bool boot_acknowledges = true;
  // Boot mode: the program must begin with 8 bytes of identification and starts after them (A-mask parts).
  bool boot_checks_id = false;
  // Boot mode: a second H'AA is sent before the program starts, else only the one after the erase check.
  bool boot_answers_twice = false;
  // Boot mode: maximum size of the program, bytes.
  int boot_program_bytes = 2048;
  // For tests: erase pulses do not change the cells of this block, 0..9; -1: no defective block.
  int flash_worn_block = -1;
  // Treat each register misuse as fatal instead of counting it.
  bool stop_on_misuse = false;

  bool operator==(const Options&) const = default;
};

}  // namespace kaz::h8s
