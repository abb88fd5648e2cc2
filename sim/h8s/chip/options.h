// Options of the emulated chip, mostly properties that the available manuals leave open.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/cpu/types.h"
#include "sim/h8s/translate/available.h"

namespace kaz::h8s {

// The defaults follow the manuals of related chips. sim/h8s/README.md and docs/explanation/emulator.md have
// the evidence. Times are in states.
struct Options {
  Engine engine = Engine::translator;
  // Number of jumps to an address before its code is translated; affects speed only.
  std::uint32_t translate_after = 100;
  // Levels of MD1 and MD0 at reset. 2 is single-chip advanced mode (24-bit addresses), 3 single-chip normal
  // mode (16-bit addresses). 0 with P42, P41 and P40 high is boot mode.
  int mode = 2;
  // An interrupt is accepted at the first instruction boundary that is more than this time after the request
  // (hardware manual, interrupt response times).
  int interrupt_decision_states = 3;
  // Duration of the exception sequence in addition to stacking, vector and first fetch.
  int exception_internal_states = 2;
  // CCR after reset. Only bit 7 (I) is documented; it is always set.
  std::uint8_t reset_ccr = 0x80;
  // RTE holds interrupts off for one instruction, like LDC, ANDC, ORC and XORC.
  bool rte_holds_off = false;
  // The FRT, the 8-bit timers and the watchdogs are on a 16-bit bus (2 states per word), else on an 8-bit bus
  // (4 states per word).
  bool wide_timer_bus = true;
  // DTC: decision time from the request to the activation, as for interrupts.
  int dtc_decision_states = 3;
  // DTC: accesses to the register information for each transfer, and internal states for each activation, in
  // addition to the vector (1) and the data. Manuals of other families: J = 6, M = 3.
  int dtc_register_accesses = 6;
  int dtc_internal_states = 3;
  // A/D: start delay tD of the first conversion: 10..17 states with CKS = 0, 6..9 with CKS = 1.
  int adc_start_delay_slow = 17;
  int adc_start_delay_fast = 9;
  // SCI: after the transmitter is enabled, one frame of mark precedes the first character.
  bool sci_preamble = true;
  // SCI: a frame begins at the next edge of the free-running bit clock, else immediately. With the clock
  // output at SCK it always waits, because data change at the falling edge of that clock.
  bool sci_aligned_start = false;
  // SCI: a byte received as levels at RxD becomes available at the sample of the first stop bit, else at the
  // end of the last stop bit, as with Chip::receive.
  bool sci_ready_mid_stop = false;
  // System clock, Hz. Used only for flash times, which are specified in microseconds, and for the bit rates
  // of boot mode.
  std::int64_t clock_hz = 18'432'000;
  // The effect of a flash pulse depends on its length, and waits are checked. Else each pulse has its full
  // effect at its end.
  bool flash_timing = true;
  // Seed that selects the cells which a short or interrupted pulse changes.
  std::uint64_t flash_seed = 1;
  // 8-bit PWM: pulses are at the end of their slot of 16 counts, else at its beginning.
  bool pwm_right_aligned = true;
  // 14-bit PWM: with OS = 0 the data is the low time of the pin (with OS = 1 the high time).
  bool pwmx_data_is_low = true;
  // Value read from a write-only, stopped or unmapped register.
  std::uint8_t undefined_read = 0xff;
  // Level of an input pin without a drive from the board and without a pull-up.
  bool floating_level = false;
  // Duration of a watchdog reset.
  int watchdog_reset_states = 518;
  // Period of the subclock at EXCL; 0: no subclock.
  int subclock_states = 0;
  // STC to memory also writes the register to the low byte of the word, else 0.
  bool stc_copies = false;
  // MOV Rs,@-ERd with Rs part of ERd (also PUSH.W R7, PUSH.L ER7) stores the value of the register after the
  // decrement, else before. MOV @ERs+,Rd with Rd part of ERs is not affected: the loaded value is written
  // last.
  bool predecrement_stores_decremented = true;
  // Boot mode: number of the serial channel, SCI0 (P50, P51) or SCI1 (P25, P26).
  int boot_channel = 0;
  // Boot mode: accepts the bit rates of A-mask parts (19,200 to 4,800 bit/s), else 9,600 to 2,400 bit/s.
  bool boot_a_mask_rates = false;
  // Boot mode: H'55 is acknowledged with H'AA.
  bool boot_acknowledges = true;
  // Boot mode: the program must begin with 8 bytes of identification, and starts after them (A-mask parts).
  bool boot_checks_id = false;
  // Boot mode: a second H'AA is sent before the program starts, else only one after the erase check.
  bool boot_answers_twice = false;
  // Boot mode: maximum size of the program, bytes.
  int boot_program_bytes = 2048;
  // For tests: number of a defective flash block (0..9) that erase pulses do not change; -1: none.
  int flash_worn_block = -1;
  // Stops at a register misuse (Reason::undefined_register_use) instead of only counting it.
  bool stop_on_misuse = false;

  bool operator==(const Options&) const = default;
};

}  // namespace kaz::h8s
