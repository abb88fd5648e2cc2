// The waveforms of both PWM timers against their pulse division, state by state.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/chip/pwm.h"
#include "sim/h8s/chip/pwmx.h"

namespace kaz::h8s::testing {
namespace {

// Basic pulses with an extra count, by the lower nibble of PWDR (hardware manual, PWM timer).
const std::vector<std::vector<unsigned>> kExtended{
    {},
    {15},
    {7, 15},
    {7, 11, 15},
    {3, 7, 11, 15},
    {3, 7, 11, 13, 15},
    {3, 5, 7, 11, 13, 15},
    {3, 5, 7, 9, 11, 13, 15},
    {1, 3, 5, 7, 9, 11, 13, 15},
    {1, 3, 5, 7, 9, 11, 13, 14, 15},
    {1, 3, 5, 6, 7, 9, 11, 13, 14, 15},
    {1, 3, 5, 6, 7, 9, 10, 11, 13, 14, 15},
    {1, 2, 3, 5, 6, 7, 9, 10, 11, 13, 14, 15},
    {1, 2, 3, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15},
    {1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15},
    {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}};

bool table_pulse(unsigned data, unsigned count) {
  const unsigned width = data >> 4, c = count & 15;
  const auto& longer = kExtended[data & 15];
  const bool extra = std::find(longer.begin(), longer.end(), count >> 4) != longer.end();
  return c >= 16 - width || (extra && c == 15 - width);
}

TEST(PwmWaveform, EachDataValueFollowsTheTable) {
  for (unsigned data = 0; data < 256; ++data) {
    for (unsigned count = 0; count < 256; ++count) {
      ASSERT_EQ(pwm_pulse(static_cast<std::uint8_t>(data), count, true), table_pulse(data, count))
          << "PWDR " << data << " count " << count;
    }
  }
}

// At the pin: PW5 at every state of a conversion period, direct and inverted, at phi and phi/4.
TEST(PwmWaveform, AppearsAtThePinStateByState) {
  for (const unsigned data : {0x00u, 0x01u, 0x37u, 0x80u, 0xf9u, 0xffu}) {
    for (const bool inverted : {false, true}) {
      for (const unsigned divisor : {1u, 4u}) {
        Program p;
        p.modules_on().out8(0xffffb0, 0x20);
        p.out8(0xffff82, 0x02);  // PCSR: phi/4 where PWCKS = 1
        p.out8(0xffffd5, inverted ? 0x20 : 0).out8(0xffffd6, 0x25);
        p.out8(0xffffd7, static_cast<std::uint8_t>(data)).out8(0xffffd3, 0x20);
        p.out8(0xffffd6, divisor == 1 ? 0xa5 : 0xe5);
        const std::uint32_t begun = end_of(p);
        p.nops(1100).stay();
        Chip chip = make_chip(p);
        ASSERT_TRUE(run_to(chip, begun));
        const States start = chip.now();
        for (States k = 0; k < 256 * divisor; ++k) {
          const auto count = static_cast<unsigned>(chip.now() / divisor - start / divisor) & 255;
          ASSERT_EQ((chip.output(Port::p1).level >> 5 & 1) != 0,
                    table_pulse(data, count) != inverted)
              << data << " at count " << count;
          chip.step();
        }
      }
    }
  }
}

// The data value is the number of counts in the pulse of a conversion period.
TEST(PwmxWaveform, PulseCountIsTheDataAboveOneCountABaseCycle) {
  for (const bool long_cycle : {false, true}) {
    const unsigned smallest = long_cycle ? 0x40 : 0x100;
    for (const unsigned data :
         {0u, smallest - 1, smallest, smallest + 1, 0x1234u, 0x2aaau, 0x3fffu}) {
      unsigned counts = 0;
      for (unsigned count = 0; count < 0x4000; ++count)
        counts += pwmx_pulse(data, long_cycle, count);
      EXPECT_EQ(counts, data < smallest ? 0 : data) << data;
    }
  }
}

// Base cycles differ by one count at most, and the longer ones are evenly distributed.
TEST(PwmxWaveform, SpreadsTheLowerBitsEvenly) {
  const unsigned data = 0x0500 | 0x80;  // CFS = 0: width 5, and one more in 128 of 256 cycles
  for (unsigned cycle = 0; cycle < 256; ++cycle) {
    unsigned width = 0;
    for (unsigned c = 0; c < 64; ++c) width += pwmx_pulse(data, false, cycle * 64 + c);
    EXPECT_EQ(width, cycle % 2 == 1 ? 6u : 5u) << cycle;
  }
}

Program pwmx_on(unsigned dadra, std::uint8_t dacr) {
  Program p;
  p.modules_on().out8(0xffffc3, 0x10);  // STCR.IICE
  p.out8(0xffffa6, 0xff).out8(0xffffa7, 0xfe);
  p.out8(0xffffa0, static_cast<std::uint8_t>(dadra >> 8));
  p.out8(0xffffa1, static_cast<std::uint8_t>(dadra));
  p.out8(0xffffa7, 0xff);  // REGS = 1
  return p.out8(0xffffa0, dacr);
}

TEST(Pwmx, DrivesItsPinWithTheDataAsLowTime) {
  for (const bool inverted : {false, true}) {
    // DADRA: data 0x0640 (width 25 at CFS = 1: 0x640 = 25 * 64), base cycle 256 T, T = 1 state.
    Program p = pwmx_on(0x0640 << 2 | 3, inverted ? 0x76 : 0x74);
    const std::uint32_t begun = end_of(p);
    p.nops(600).stay();
    Chip chip = make_chip(p);
    ASSERT_TRUE(run_to(chip, begun));
    const States start = chip.now();
    for (int k = 0; k < 520; ++k) {
      const bool pulse = (chip.now() - start) % 256 < 25;
      ASSERT_EQ((chip.output(Port::p1).level & 1) != 0, pulse == inverted) << k;
      EXPECT_EQ(chip.output(Port::p1).driven & 3, 1);
      chip.step();
    }
  }
}

TEST(Pwmx, RegistersShareAddressesByRegsAndNeedIice) {
  Program p = pwmx_on(0x1236 << 2 | 3, 0x30);
  p.out8(0xffffa6, 0x34).out8(0xffffa7, 0x57);  // DACNT: bits 7..0 = 34, 13..8 from 010101
  const std::uint32_t counter = end_of(p);
  p.out8(0xffffa7, 0x00).in8(0xffffa0);
  const std::uint32_t data = end_of(p);
  p.out8(0xffffc3, 0x00).in8(0xffffa0).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, counter));
  EXPECT_EQ(chip.peek(0xffffa0), 0x30);  // DACR
  EXPECT_EQ(chip.peek16(0xffffa6), 0x3457);
  ASSERT_TRUE(run_to(chip, data));
  EXPECT_EQ(chip.peek16(0xffffa0), 0x1236 << 2 | 3);
  EXPECT_EQ(chip.registers().er[0] & 0xff, 0x1236u >> 6);
  EXPECT_TRUE(chip.misuse().empty());
  chip.run_until(chip.now() + 50);
  ASSERT_EQ(chip.misuse().size(), 1u);
  EXPECT_EQ(chip.misuse()[0].address, 0xffffa0u);
}

TEST(Pwmx, ModuleStopResetsIt) {
  Program p = pwmx_on(0x1236 << 2 | 3, 0x74);
  p.out16(kMstpcr, 0x0800).out16(kMstpcr, 0x0000).stay();
  Chip chip = make_chip(p);
  chip.run_until(400);
  EXPECT_EQ(chip.peek16(0xffffa0), 0xffff);
  EXPECT_EQ(chip.output(Port::p1).driven & 3, 0);
}

}  // namespace
}  // namespace kaz::h8s::testing
