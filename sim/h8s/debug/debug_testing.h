// Test fixtures: a chip with active timer, serial and A/D interrupts, and a comparison of two chips.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {

// Returns a program that starts the modules with interrupts, and then computes in an endless loop.
inline Program busy_program() {
  Program p;
  p.modules_on().out8(0xffffd9, 4).out8(0xffffda, 0x70).out16(0xffff94, 99).out8(0xffff91, 0x01);
  p.out8(0xffff90, 0x09).out8(0xffffe8, 0x3b).out8(0xffffc8, 0x09).out8(0xffffca, 0x03);
  p.enable_interrupts();
  const std::uint32_t loop = end_of(p);
  p.words({0x0b70, 0x0f81, 0x5210});  // inc.l #1,er0 ; mov.l er0,er1 ; mulxu.w r1,er0
  p.words({0x0100, 0x6b80, 0xe100});  // mov.l er0,@0xffe100:16
  p.word(static_cast<std::uint16_t>(0x4000 | ((loop - end_of(p) - 2) & 0xff)));
  return p;
}

// Returns the address of the endless loop.
inline std::uint32_t busy_loop() {
  return end_of(busy_program()) - 14;
}

// Returns a chip with busy_program(), interrupt handlers, input voltages and queued serial bytes.
inline Chip busy_chip(Options options = {}) {
  Chip chip = make_chip(busy_program(), options);
  // Handlers of FRT OCIA and SCI0 reception: clear the flag and return.
  chip.poke(handler(52), std::vector<std::uint8_t>{0x7f, 0x91, 0x72, 0x30, 0x56, 0x70});
  chip.poke(handler(81), std::vector<std::uint8_t>{0x7f, 0xdc, 0x72, 0x60, 0x56, 0x70});
  chip.set_analog([](int channel, States) { return channel / 8.0; });
  for (States k = 1; k < 10; ++k)
    EXPECT_TRUE(chip.receive(0, {static_cast<std::uint8_t>(k), 3000 * k}).has_value());
  return chip;
}

// Expects equal time, registers and memory.
inline void expect_same(const Chip& a, const Chip& b) {
  EXPECT_EQ(a.now(), b.now());
  EXPECT_EQ(a.instructions(), b.instructions());
  EXPECT_EQ(a.registers(), b.registers());
  for (std::uint32_t at = 0xffe080; at < 0x1000000; ++at)
    ASSERT_EQ(a.peek(at), b.peek(at)) << std::hex << at;
}

}  // namespace kaz::h8s::testing
