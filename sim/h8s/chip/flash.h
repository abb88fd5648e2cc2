// Flash controller. Flash is programmed and erased by the steps that the manual prescribes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/h8s/chip/chip.h"
#include "sim/h8s/chip/register_names.h"
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

class Machine;

// Wait times and pulse lengths of the chip generation with 32-byte flash lines, microseconds. Source:
// hardware manual, flash memory programming and erasing flowcharts, non-A-mask part
// (docs/explanation/emulator.md).
namespace flash_times {
inline constexpr double kAfterSwe = 10, kAfterPsu = 50, kAfterEsu = 200, kAfterPv = 4,
                        kAfterEv = 20, kAfterDummy = 2;
inline constexpr double kProgramLeast = 150, kProgramMost = 200;
inline constexpr double kEraseLeast = 5'000, kEraseMost = 10'000;
// A pulse shorter than this fraction of the minimum pulse changes no cell.
inline constexpr double kNothingBelow = 0.125;
inline constexpr int kEndurance = 100;  // number of erasures that a block endures
}  // namespace flash_times

class FlashControl {
 public:
  // Register accesses while STCR.FLSHE is 1: FLMCR1, FLMCR2, EBR1 and EBR2.
  std::uint8_t peek(std::uint32_t address) const;
  void write(Machine& m, std::uint32_t address, std::uint8_t value, States at);
  // Latches a byte that the program writes to an address inside the flash.
  void latch(Machine& m, std::uint32_t address, std::uint8_t value);

  bool enabled() const { return (flmcr1_ & FLMCR1::SWE) != 0; }
  // Returns whether reads are normal: no pulse or setup is active, and verification is off.
  bool plain() const { return !busy() && (flmcr1_ & kVerify) == 0; }
  // Returns whether a pulse or its setup is active. While busy() is true, a read, fetch or exception is an
  // error.
  bool busy() const { return (flmcr1_ & kPulse) != 0 || (flmcr2_ & FLMCR2::PSU) != 0; }
  // Returns the value that a read yields while plain() is false. `cell` is the stored byte.
  std::uint8_t read(Machine& m, std::uint32_t address, std::uint8_t cell, States at);
  // Enters error protection: sets FLER and ends the running pulse early. No other pulse begins before a
  // reset.
  void error(Machine& m, const char* text, States at);
  // Applies an erase pulse to one block. `share` is the pulse length as a fraction of a full pulse. If
  // `share` is below 1, only some cells or no cells change.
  void erase_block(Machine& m, unsigned block, double share);
  static constexpr unsigned kBlockCount = 10;
  static std::uint32_t size_of(unsigned block);
  bool blank(Machine& m, unsigned block) const;
  // Must be called at a reset or power cut. If a pulse is running, the pulse has a partial effect.
  void cut(Machine& m, States at);

  FlashStatistics statistics;

  // Serializes the complete state (shared/base/archive.hpp).
  template <class A>
  void transfer(A& a) {
    a(flmcr1_, flmcr2_, ebr1_, ebr2_, line_, latched_, data_, dummy_, pulse_start_, swe_at_,
      setup_at_, verify_at_, dummy_at_, pulses_, statistics);
    a.require(line_ < kFlashSize && line_ % 32 == 0, "line of flash");
  }

 private:
  static constexpr std::uint8_t kVerify = FLMCR1::EV | FLMCR1::PV, kPulse = FLMCR1::E | FLMCR1::P,
                                kModes = kVerify | kPulse;

  void end_pulse(Machine& m, States at);
  void program(Machine& m, double share);
  void erase(Machine& m, double share);
  void require(Machine& m, States since, double wait, States at, const char* text);
  double microseconds(const Machine& m, States states) const;
  bool cell_moves(const Machine& m, std::uint32_t cell, double share) const;

  std::uint8_t flmcr1_ = FLMCR1::FWE, flmcr2_ = 0, ebr1_ = 0, ebr2_ = 0;
  std::uint32_t line_ = 0;     // address of the 32-byte line to program
  std::uint32_t latched_ = 0;  // one bit for each latched byte of the line
  std::array<std::uint8_t, 32> data_{};
  std::uint32_t dummy_ = 0xffffffff;  // address that a dummy write has selected for verification
  States pulse_start_ = 0, swe_at_ = 0, setup_at_ = 0, verify_at_ = 0, dummy_at_ = 0;
  std::uint32_t pulses_ = 0;
};

}  // namespace kaz::h8s
