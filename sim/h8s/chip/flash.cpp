// Flash controller (h8s2128, flash section: 32-byte lines, erase blocks, non-A-mask part).
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/flash.h"

#include <bit>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

constexpr std::uint8_t kSwe = 0x40, kErase = 0x02, kProgram = 0x01;
constexpr std::uint8_t kFler = 0x80, kEsu = 0x02, kPsu = 0x01;
constexpr std::uint32_t kBlocks[] = {0x0000, 0x0400, 0x0800,  0x0c00,  0x1000, 0x8000,
                                     0xc000, 0xe000, 0x10000, 0x18000, 0x20000};

}  // namespace

std::uint8_t FlashControl::peek(std::uint32_t address) const {
  switch (address) {
    case 0xff80:
      return flmcr1_;
    case 0xff81:
      return flmcr2_;
    case 0xff82:
      return ebr1_;
    default:
      return ebr2_;
  }
}

void FlashControl::latch(Machine& m, std::uint32_t address, std::uint8_t value) {
  if (!(flmcr1_ & kSwe)) {
    m.misuse(address, "write to flash memory without FLMCR1.SWE");
    return;
  }
  // A dummy write in verify mode only latches the address.
  if (flmcr1_ & 0x0c) return;
  const std::uint32_t line = address & ~31u;
  if (line != line_) latched_ = 0;
  line_ = line;
  data_[address & 31] = value;
  latched_ |= 1u << (address & 31);
}

void FlashControl::program(Machine& m, States) {
  if (latched_ != 0xffffffff) m.misuse(line_, "flash programmed with fewer than 32 bytes latched");
  std::uint8_t* p = m.memory_at(line_);
  for (unsigned k = 0; p && k < 32; ++k) {
    if (latched_ >> k & 1) p[k] = static_cast<std::uint8_t>(p[k] & data_[k]);
  }
  m.forget_flash(line_, 32);
}

void FlashControl::erase(Machine& m, States) {
  const unsigned blocks = static_cast<unsigned>(ebr1_ & 3) << 8 | ebr2_;
  if (std::popcount(blocks) != 1) {
    m.misuse(0xff82, "flash erased with other than exactly one block selected");
    return;
  }
  const auto n = static_cast<unsigned>(std::countr_zero(blocks));
  std::uint8_t* p = m.memory_at(kBlocks[n]);
  const std::uint32_t size = kBlocks[n + 1] - kBlocks[n];
  for (std::uint32_t k = 0; p && k < size; ++k) p[k] = 0xff;
  m.forget_flash(kBlocks[n], size);
}

void FlashControl::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  const bool locked = (flmcr2_ & kFler) != 0;
  switch (address) {
    case 0xff80: {
      const std::uint8_t before = flmcr1_;
      std::uint8_t next = static_cast<std::uint8_t>(0x80 | (value & 0x4f));
      if (!(next & kSwe)) next = 0x80, ebr1_ = ebr2_ = 0;
      if (!(flmcr2_ & kPsu) || locked) next = static_cast<std::uint8_t>(next & ~kProgram);
      if (!(flmcr2_ & kEsu) || locked) next = static_cast<std::uint8_t>(next & ~kErase);
      flmcr1_ = next;
      const auto ended = static_cast<std::uint8_t>(before & ~next);
      if (~before & next & (kProgram | kErase)) pulse_start_ = at;
      if (ended & kProgram) program(m, at - pulse_start_);
      if (ended & kErase) erase(m, at - pulse_start_);
      break;
    }
    case 0xff81:
      flmcr2_ = static_cast<std::uint8_t>((flmcr2_ & kFler) | (flmcr1_ & kSwe ? value & 3 : 0));
      break;
    case 0xff82:
      ebr1_ = flmcr1_ & kSwe ? value & 3 : 0;
      break;
    default:
      ebr2_ = flmcr1_ & kSwe ? value : 0;
      break;
  }
}

}  // namespace kaz::h8s
