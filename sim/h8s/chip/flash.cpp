// Flash controller (hardware manual, flash memory: 32-byte lines, erase blocks, non-A-mask part).
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/flash.h"

#include <algorithm>
#include <bit>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

namespace times = flash_times;

constexpr std::uint32_t kBlocks[] = {0x0000, 0x0400, 0x0800,  0x0c00,  0x1000, 0x8000,
                                     0xc000, 0xe000, 0x10000, 0x18000, 0x20000};

unsigned block_of(std::uint32_t address) {
  unsigned n = 0;
  while (n < 9 && address >= kBlocks[n + 1]) ++n;
  return n;
}

// Hash to 0..1: selects the cells that a weak pulse changes and the data of a forbidden read.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

}  // namespace

std::uint8_t FlashControl::peek(std::uint32_t address) const {
  switch (address) {
    case io::FLMCR1:
      return flmcr1_;
    case io::FLMCR2:
      return flmcr2_;
    case io::EBR1:
      return ebr1_;
    default:
      return ebr2_;
  }
}

double FlashControl::microseconds(const Machine& m, States states) const {
  return static_cast<double>(states) * 1e6 / static_cast<double>(m.options.clock_hz);
}

void FlashControl::require(Machine& m, States since, double wait, States at, const char* text) {
  if (m.options.flash_timing && microseconds(m, at - since) < wait) m.misuse(io::FLMCR1, text);
}

void FlashControl::latch(Machine& m, std::uint32_t address, std::uint8_t value) {
  const States at = m.time();
  if (!(flmcr1_ & FLMCR1::SWE)) {
    m.misuse(address, "write to flash memory without FLMCR1.SWE");
    return;
  }
  if (busy()) {
    m.misuse(address, "write to flash memory while PSU, P or E is set; the write has no effect");
    return;
  }
  // In verify mode a dummy write selects the word to be read.
  if (flmcr1_ & kVerify) {
    if (value != 0xff)
      m.misuse(address,
               "the dummy write for a verification read must write FF, but wrote another value");
    require(m, verify_at_, flmcr1_ & FLMCR1::PV ? times::kAfterPv : times::kAfterEv, at,
            "dummy write too early after PV or EV was set");
    dummy_ = address & ~1u;
    dummy_at_ = at;
    return;
  }
  require(m, swe_at_, times::kAfterSwe, at, "flash written too early after SWE was set");
  const std::uint32_t line = address & ~31u;
  if (line != line_) latched_ = 0;
  line_ = line;
  data_[address & 31] = value;
  latched_ |= 1u << (address & 31);
}

std::uint8_t FlashControl::read(Machine& m, std::uint32_t address, std::uint8_t cell, States at) {
  if (busy()) {
    error(m, "flash read during programming or erasing; FLER is set", at);
    return static_cast<std::uint8_t>(mixed(m.options.flash_seed ^ address));
  }
  if (dummy_ != (address & ~1u))
    m.misuse(address, "verification read without an earlier dummy write to the same word");
  else
    require(m, dummy_at_, times::kAfterDummy, at, "verification read too early after dummy write");
  return cell;
}

void FlashControl::error(Machine& m, const char* text, States at) {
  m.misuse(io::FLMCR2, text);
  end_pulse(m, at);
  flmcr1_ &= ~kPulse;
  flmcr2_ = FLMCR2::FLER;
  ++statistics.errors;
  m.choose_paths();
}

// A weak pulse changes some of its cells, selected by the seed and the pulse's number.
bool FlashControl::cell_moves(const Machine& m, std::uint32_t cell, double share) const {
  if (share >= 1) return true;
  if (share < times::kNothingBelow) return false;
  const std::uint64_t r = mixed(m.options.flash_seed ^ mixed(cell) ^ std::uint64_t{pulses_} << 40);
  return static_cast<double>(r >> 11) * 0x1p-53 < share;
}

void FlashControl::program(Machine& m, double share) {
  FlashStatistics::Block& b = statistics.blocks[block_of(line_)];
  ++b.program_pulses;
  if (latched_ != 0xffffffff)
    m.misuse(line_, "programming pulse before all 32 bytes of the flash line were written");
  std::uint8_t* p = m.memory_at(line_);
  bool again = false;
  for (unsigned k = 0; p && k < 32; ++k) {
    if (!(latched_ >> k & 1)) continue;
    for (unsigned bit = 0; bit < 8; ++bit) {
      const auto mask = static_cast<std::uint8_t>(1u << bit);
      if (data_[k] & mask) continue;
      again |= !(p[k] & mask);
      if (cell_moves(m, (line_ + k) * 8 + bit, share)) p[k] &= static_cast<std::uint8_t>(~mask);
    }
  }
  if (again) ++b.reprogrammed;
  if (share < 1) ++b.weak_pulses;
  m.forget_flash(line_, 32);
}

void FlashControl::erase(Machine& m, double share) {
  const unsigned selected = static_cast<unsigned>(ebr1_ & EBR1::EB) << 8 | ebr2_;
  if (std::popcount(selected) != 1) {
    m.misuse(
        io::EBR1,
        "erase pulse with no block or several blocks selected in EBR1 and EBR2; nothing is erased");
    return;
  }
  erase_block(m, static_cast<unsigned>(std::countr_zero(selected)), share);
}

std::uint32_t FlashControl::size_of(unsigned block) {
  return kBlocks[block + 1] - kBlocks[block];
}

bool FlashControl::blank(Machine& m, unsigned block) const {
  const std::uint8_t* p = m.memory_at(kBlocks[block]);
  return std::all_of(p, p + size_of(block), [](std::uint8_t byte) { return byte == 0xff; });
}

void FlashControl::erase_block(Machine& m, unsigned n, double share) {
  FlashStatistics::Block& b = statistics.blocks[n];
  ++b.erase_pulses;
  if (share < 1) ++b.weak_pulses;
  if (share < times::kNothingBelow || m.options.flash_worn_block == static_cast<int>(n)) return;
  if (++b.erasures == times::kEndurance + 1)
    m.misuse(io::EBR1, "flash block erased more than 100 times; the endurance is 100 erasures");
  std::uint8_t* p = m.memory_at(kBlocks[n]);
  const std::uint32_t size = kBlocks[n + 1] - kBlocks[n];
  for (std::uint32_t k = 0; p && k < size; ++k) {
    if (share >= 1) {
      p[k] = 0xff;
      continue;
    }
    for (unsigned bit = 0; bit < 8; ++bit)
      if (cell_moves(m, (kBlocks[n] + k) * 8 + bit, share))
        p[k] |= static_cast<std::uint8_t>(1u << bit);
  }
  m.forget_flash(kBlocks[n], size);
}

// Applies what the running pulse has done by `at`.
void FlashControl::end_pulse(Machine& m, States at) {
  if (!(flmcr1_ & kPulse)) return;
  ++pulses_;
  const bool writes = (flmcr1_ & FLMCR1::P) != 0;
  const double length = microseconds(m, at - pulse_start_);
  const double min_us = writes ? times::kProgramLeast : times::kEraseLeast;
  const double max_us = writes ? times::kProgramMost : times::kEraseMost;
  double share = 1;
  if (m.options.flash_timing) {
    share = length / min_us;
    if (share < 1)
      m.misuse(io::FLMCR1, "flash pulse shorter than the manual requires; cells are left weak");
    // Tolerance of 10% for a polling loop.
    if (length > 1.1 * max_us) m.misuse(io::FLMCR1, "flash pulse longer than the manual allows");
  }
  if (writes)
    program(m, share);
  else
    erase(m, share);
}

void FlashControl::cut(Machine& m, States at) {
  end_pulse(m, at);
  const FlashStatistics worn = statistics;
  const std::uint32_t pulses = pulses_;
  *this = {};
  statistics = worn;
  pulses_ = pulses;
}

void FlashControl::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  const bool locked = (flmcr2_ & FLMCR2::FLER) != 0;
  const bool from_flash = m.pc() < m.cpu.flash_size;
  switch (address) {
    case io::FLMCR1: {
      const std::uint8_t before = flmcr1_;
      std::uint8_t next = FLMCR1::FWE | (value & (FLMCR1::SWE | kModes));
      if (!(next & FLMCR1::SWE)) next = FLMCR1::FWE, ebr1_ = ebr2_ = 0;
      if (!(flmcr2_ & FLMCR2::PSU) || locked) next &= ~FLMCR1::P;
      if (!(flmcr2_ & FLMCR2::ESU) || locked) next &= ~FLMCR1::E;
      // Both at once, or together with verification, is not an operation.
      if (std::popcount(static_cast<unsigned>(next & kModes)) > 1) {
        m.misuse(io::FLMCR1,
                 "more than one of the bits EV, PV, E and P set; none of the four has an effect");
        next &= ~kModes;
      }
      const auto ended = static_cast<std::uint8_t>(before & ~next);
      const auto begun = static_cast<std::uint8_t>(~before & next);
      if (ended & kPulse) end_pulse(m, at);
      flmcr1_ = next;
      if (begun & FLMCR1::SWE) swe_at_ = at;
      if ((begun | ended) & FLMCR1::SWE && from_flash)
        m.misuse(io::FLMCR1,
                 "SWE changed by code in flash; code that changes SWE must run from RAM");
      if (begun & kPulse) {
        pulse_start_ = at;
        require(m, setup_at_, begun & FLMCR1::P ? times::kAfterPsu : times::kAfterEsu, at,
                "flash pulse begun too early after PSU or ESU was set");
      }
      if (begun & kVerify) verify_at_ = at;
      dummy_ = 0xffffffff;
      break;
    }
    case io::FLMCR2: {
      const std::uint8_t next =
          flmcr1_ & FLMCR1::SWE && !locked ? value & (FLMCR2::ESU | FLMCR2::PSU) : 0;
      if ((flmcr1_ & FLMCR1::P && !(next & FLMCR2::PSU)) ||
          (flmcr1_ & FLMCR1::E && !(next & FLMCR2::ESU))) {
        m.misuse(io::FLMCR2, "PSU or ESU cleared during a pulse; the pulse ends");
        end_pulse(m, at);
        flmcr1_ &= ~kPulse;
      }
      if (next & ~flmcr2_) setup_at_ = at;
      flmcr2_ = (flmcr2_ & FLMCR2::FLER) | next;
      break;
    }
    case io::EBR1:
      ebr1_ = flmcr1_ & FLMCR1::SWE ? value & EBR1::EB : 0;
      break;
    default:
      ebr2_ = flmcr1_ & FLMCR1::SWE ? value : 0;
      break;
  }
  m.choose_paths();
  if (busy() && from_flash)
    error(m, "instruction fetch from flash during programming or erasing; FLER is set", at);
}

}  // namespace kaz::h8s
