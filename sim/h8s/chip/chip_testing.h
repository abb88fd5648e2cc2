// Test fixtures: small programs and chips that run them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "sim/h8s/chip/chip.h"

namespace kaz::h8s::testing {

inline constexpr std::uint32_t kCode = 0x1000;      // start of programs
inline constexpr std::uint32_t kHandlers = 0x8000;  // handler of vector n: kHandlers + 16 n
inline constexpr std::uint32_t kRamData = 0xffe100;
inline constexpr std::uint32_t kStack = 0xfff000;

inline std::uint32_t handler(unsigned vector) {
  return kHandlers + 16 * vector;
}

// Address of the module stop register.
inline constexpr std::uint32_t kMstpcr = 0xffff86;

// Returns a powered-on chip with `words` at kCode. Each of the vectors 1..103 has the handler `bra .`. ER7 is
// kStack.
inline Chip make_chip(const std::vector<std::uint16_t>& words, Options options = {}) {
  Image image;
  Segment vectors{0, 0, "vectors", {}};
  for (unsigned v = 0; v < 104; ++v) {
    const std::uint32_t to = v == 0 ? kCode : handler(v);
    for (int shift = 24; shift >= 0; shift -= 8)
      vectors.bytes.push_back(static_cast<std::uint8_t>(to >> shift));
    image.segments.push_back({handler(v), handler(v), "handler", {0x40, 0xfe}});
  }
  Segment code{kCode, kCode, "code", {}};
  for (const std::uint16_t w : words) {
    code.bytes.push_back(static_cast<std::uint8_t>(w >> 8));
    code.bytes.push_back(static_cast<std::uint8_t>(w));
  }
  image.segments.push_back(vectors);
  image.segments.push_back(code);
  Chip chip(options);
  EXPECT_TRUE(chip.load(image).has_value());
  chip.power_on();
  Registers r = chip.registers();
  r.er[7] = kStack;
  chip.set_registers(r);
  return chip;
}

// Builder of programs, mostly of accesses to I/O registers.
class Program {
 public:
  Program& word(std::uint16_t w) {
    words_.push_back(w);
    return *this;
  }
  Program& words(std::initializer_list<std::uint16_t> ws) {
    for (const std::uint16_t w : ws) words_.push_back(w);
    return *this;
  }
  // mov.b #value,r0l; mov.b r0l,@address:16. Takes 1 + 3 states, plus 1 state for an I/O register.
  Program& out8(std::uint32_t address, std::uint8_t value) {
    return words(
        {static_cast<std::uint16_t>(0xf800 | value), 0x6a88, static_cast<std::uint16_t>(address)});
  }
  // mov.w #value,r0; mov.w r0,@address:16. Takes 2 + 3 states, plus 1 or 3 states for an I/O register.
  Program& out16(std::uint32_t address, std::uint16_t value) {
    return words({0x7900, value, 0x6b80, static_cast<std::uint16_t>(address)});
  }
  // mov.b @address:16,r0l.
  Program& in8(std::uint32_t address) {
    return words({0x6a08, static_cast<std::uint16_t>(address)});
  }
  Program& enable_interrupts() { return word(0x067f); }  // andc #0x7f,ccr
  Program& nops(int n) {
    for (int k = 0; k < n; ++k) word(0x0000);
    return *this;
  }
  Program& stay() { return word(0x40fe); }  // bra .
  // Clears all module stop bits.
  Program& modules_on() { return out16(kMstpcr, 0x0000); }
  const std::vector<std::uint16_t>& get() const { return words_; }

 private:
  std::vector<std::uint16_t> words_;
};

inline Chip make_chip(const Program& program, Options options = {}) {
  return make_chip(program.get(), options);
}

// Steps until PC is `address`. Returns false after 200,000 steps or a stop.
inline bool run_to(Chip& chip, std::uint32_t address) {
  for (int k = 0; k < 200'000; ++k) {
    if (chip.registers().pc == address) return true;
    if (chip.step().reason != Stop::Reason::reached) return false;
  }
  return false;
}

// Returns the address after the last word of a program.
inline std::uint32_t end_of(const Program& p) {
  return kCode + 2 * static_cast<std::uint32_t>(p.get().size());
}

}  // namespace kaz::h8s::testing
