// Options of the emulated chip. Most options are properties that the available manuals do not specify.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/h8s/cpu/types.h"
#include "sim/h8s/translate/available.h"

namespace kaz::h8s {

// The defaults follow the manuals of related chips. sim/h8s/README.md and docs/explanation/emulator.md state
// the evidence for the defaults. Times are in states.
struct Options {
  Engine engine = Engine::translator;
  // Number of jumps to an address before the code at that address is translated. Affects speed only.
  std::uint32_t translate_after = 100;
  // Levels of MD1 and MD0 at reset. `mode` 2 is single-chip advanced mode (24-bit addresses), `mode` 3 is
  // single-chip normal mode (16-bit addresses). If P42, P41 and P40 are high, `mode` 0 selects boot mode.
  int mode = 2;
  // Decision time of an interrupt (hardware manual, interrupt response times). The CPU accepts interrupts at
  // instruction boundaries. At a boundary, the CPU accepts a request only if the request is older than the
  // decision time.
  int interrupt_decision_states = 3;
  // Duration of the exception sequence, without the stacking, the vector read and the first instruction
  // fetch.
  int exception_internal_states = 2;
  // CCR after reset. Bit 7 (I) of CCR is always set after reset. The manuals do not document the other bits
  // after reset.
  std::uint8_t reset_ccr = 0x80;
  // True: no interrupt is accepted between RTE and the next instruction. After LDC, ANDC, ORC or XORC, the
  // CPU never accepts an interrupt before the next instruction, regardless of this option.
  bool rte_holds_off = false;
  // Bus of the FRT, the 8-bit timers and the watchdogs. True: 16-bit bus (2 states per word). False: 8-bit
  // bus (4 states per word).
  bool wide_timer_bus = true;
  // DTC: decision time from the request to the activation, defined like interrupt_decision_states.
  int dtc_decision_states = 3;
  // DTC: number of accesses to the register information in each transfer. The vector read and the data
  // accesses are not included. The default is the value of J in the manuals of other chip families.
  int dtc_register_accesses = 6;
  // DTC: number of internal states in each activation. The default is the value of M in the manuals of other
  // chip families.
  int dtc_internal_states = 3;
  // A/D: start delay tD of the first conversion while bit CKS is 0 (10 to 17 states).
  int adc_start_delay_slow = 17;
  // A/D: start delay tD of the first conversion while bit CKS is 1 (6 to 9 states).
  int adc_start_delay_fast = 9;
  // SCI: true if the transmitter sends a preamble after the program has enabled the transmitter. The preamble
  // is the mark level for the duration of one frame. The first character follows the preamble.
  bool sci_preamble = true;
  // SCI: true if a frame waits for the next edge of the free-running bit clock, false if a frame begins
  // immediately. While SCK outputs the bit clock, a frame always waits for the next edge of this clock,
  // because TxD changes at the falling edges of SCK.
  bool sci_aligned_start = false;
  // SCI: selects when a received byte becomes available, if the bits of the byte arrive as levels at RxD.
  // True: at the sample of the first stop bit. False: at the end of the last stop bit, like a byte from
  // Chip::receive.
  bool sci_ready_mid_stop = false;
  // System clock, Hz. Used only for flash times, which are specified in microseconds, and for the bit rates
  // of boot mode.
  std::int64_t clock_hz = 18'432'000;
  // True: the effect of a flash pulse depends on its length, and the program's wait times are checked. False:
  // each flash pulse has its full effect at its end.
  bool flash_timing = true;
  // Seed that selects the cells which a short or interrupted pulse changes.
  std::uint64_t flash_seed = 1;
  // 8-bit PWM: position of a pulse in its slot of 16 counts. True: at the end. False: at the beginning.
  bool pwm_right_aligned = true;
  // 14-bit PWM: meaning of the data while bit OS is 0. True: low time of the pin. False: high time of the
  // pin. While bit OS is 1, the meaning is reversed.
  bool pwmx_data_is_low = true;
  // Value read from a write-only, stopped or unmapped register.
  std::uint8_t undefined_read = 0xff;
  // Level of an input pin that neither the board nor a pull-up drives.
  bool floating_level = false;
  // Duration of a watchdog reset.
  int watchdog_reset_states = 518;
  // Period of the subclock at EXCL; 0: no subclock.
  int subclock_states = 0;
  // Low byte of the word that STC writes to memory. True: a copy of the register. False: 0.
  bool stc_copies = false;
  // MOV Rs,@-ERd decrements ERd and stores Rs. In PUSH.L ER7 and similar instructions, Rs is a part of ERd.
  // For these instructions, the option selects the stored value. True: the value after the decrement. False:
  // the value before the decrement. The option does not affect MOV @ERs+,Rd. If Rd is a part of ERs, the CPU
  // first increments ERs and then writes the loaded value to Rd.
  bool predecrement_stores_decremented = true;
  // Boot mode: number of the serial channel, SCI0 (P50, P51) or SCI1 (P25, P26).
  int boot_channel = 0;
  // Boot mode: accepted bit rates. True: 19,200 to 4,800 bit/s (A-mask parts). False: 9,600 to 2,400 bit/s.
  bool boot_a_mask_rates = false;
  // Boot mode: true if the boot ROM answers H'55 with H'AA.
  bool boot_acknowledges = true;
  // Boot mode: true if the program must begin with 8 identification bytes; execution starts after these bytes
  // (A-mask parts).
  bool boot_checks_id = false;
  // Boot mode: number of H'AA bytes sent. False: one byte, sent after the erase check. True: a second byte is
  // sent before the program starts.
  bool boot_answers_twice = false;
  // Boot mode: maximum size of the program, bytes.
  int boot_program_bytes = 2048;
  // For tests: number (0..9) of a defective flash block, which erase pulses do not change; -1: no block is
  // defective.
  int flash_worn_block = -1;
  // True: a register misuse stops the chip (Reason::undefined_register_use). False: misuses are only counted.
  bool stop_on_misuse = false;

  bool operator==(const Options&) const = default;
};

}  // namespace kaz::h8s
