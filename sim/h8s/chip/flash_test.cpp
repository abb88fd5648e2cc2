// Flash controller: the steps of programming and erasing, what errors do, wear, power cuts.
// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/chip/machine.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kFlmcr1 = 0xffff80, kFlmcr2 = 0xffff81, kEbr1 = 0xffff82, kEbr2 = 0xffff83;
constexpr std::uint32_t kLine = 0x18020;

// A machine whose program counter is in RAM; registers are written from outside, time passes
// by hand.
struct Kernel {
  Machine m;
  explicit Kernel(Options o = {}) : m(o) {
    m.set_pc(0xffe100);
    m.io_write(0xffffc3, 0x08);
  }
  void wait(double microseconds) {
    const double states = microseconds * static_cast<double>(m.options.clock_hz) / 1e6;
    m.cpu.now += static_cast<States>(std::ceil(states));
  }
  void put(std::uint32_t address, std::uint8_t value) { m.io_write(address, value); }
  std::uint8_t get(std::uint32_t address) { return m.io_peek(address).value(); }
  void latch(std::uint32_t line, std::uint8_t value) {
    for (std::uint32_t k = 0; k < 32; ++k) m.flash_control.latch(m, line + k, value);
  }
  void open() {
    put(kFlmcr1, 0x40);
    wait(10);
  }
  void pulse(double us) {
    put(kFlmcr2, 1);
    wait(50);
    put(kFlmcr1, 0x41);
    wait(us);
    put(kFlmcr1, 0x40);
    wait(10);
    put(kFlmcr2, 0);
    wait(10);
  }
  void erase(std::uint8_t ebr1, std::uint8_t ebr2, double us) {
    put(kEbr1, ebr1);
    put(kEbr2, ebr2);
    put(kFlmcr2, 2);
    wait(200);
    put(kFlmcr1, 0x42);
    wait(us);
    put(kFlmcr1, 0x40);
    put(kFlmcr2, 0);
  }
  std::uint8_t cell(std::uint32_t at) { return *m.memory_at(at); }
};

TEST(Flash, ProgramsAndErasesByTheBook) {
  Kernel k;
  k.open();
  k.latch(kLine, 0x5a);
  k.pulse(200);
  for (std::uint32_t n = 0; n < 32; ++n) EXPECT_EQ(k.cell(kLine + n), 0x5a);
  EXPECT_EQ(k.cell(kLine - 1), 0xff);
  EXPECT_EQ(k.cell(kLine + 32), 0xff);
  // Verification: PV, 4 us, dummy write, 2 us, read.
  k.put(kFlmcr1, 0x44);
  k.wait(4);
  k.m.flash_control.latch(k.m, kLine, 0xff);
  k.wait(2);
  EXPECT_EQ(k.m.flash_control.read(k.m, kLine, k.cell(kLine), k.m.time()), 0x5a);
  k.put(kFlmcr1, 0x40);
  k.erase(2, 0, 10'000);
  EXPECT_EQ(k.cell(kLine), 0xff);
  EXPECT_TRUE(k.m.misuses.empty());
  EXPECT_EQ(k.m.flash_control.statistics.blocks[9].erasures, 1);
  EXPECT_EQ(k.m.flash_control.statistics.blocks[9].program_pulses, 1);
}

TEST(Flash, ZerosDoNotBecomeOnes) {
  Kernel k;
  k.open();
  k.latch(kLine, 0x0f);
  k.pulse(200);
  k.latch(kLine, 0xf3);
  k.pulse(200);
  EXPECT_EQ(k.cell(kLine), 0x03);
}

TEST(Flash, NothingActsWithoutItsSetup) {
  Kernel k;
  k.put(kFlmcr2, 1);  // without SWE
  EXPECT_EQ(k.get(kFlmcr2), 0);
  k.put(kEbr2, 1);
  EXPECT_EQ(k.get(kEbr2), 0);
  k.open();
  k.latch(kLine, 0);
  k.put(kFlmcr1, 0x41);  // without PSU
  EXPECT_EQ(k.get(kFlmcr1), 0xc0);
  k.put(kFlmcr1, 0x42);  // without ESU
  EXPECT_EQ(k.get(kFlmcr1), 0xc0);
  EXPECT_EQ(k.cell(kLine), 0xff);
  k.put(kEbr2, 1);
  EXPECT_EQ(k.get(kEbr2), 1);
  k.put(kFlmcr1, 0);  // SWE off clears the selection
  EXPECT_EQ(k.get(kEbr2), 0);
}

TEST(Flash, ShortPulsesLeaveWeakCells) {
  Kernel none;
  none.open();
  none.latch(kLine, 0x00);
  none.pulse(10);
  EXPECT_EQ(none.cell(kLine), 0xff);
  Kernel half, same, other([] {
    Options o;
    o.flash_seed = 99;
    return o;
  }());
  unsigned zeros = 0, differ = 0;
  for (Kernel* k : {&half, &same, &other}) {
    k->open();
    k->latch(kLine, 0x00);
    k->pulse(75);
  }
  for (std::uint32_t n = 0; n < 32; ++n) {
    EXPECT_EQ(half.cell(kLine + n), same.cell(kLine + n));
    differ += half.cell(kLine + n) != other.cell(kLine + n);
    zeros += 8u - static_cast<unsigned>(std::popcount(half.cell(kLine + n)));
  }
  EXPECT_NEAR(zeros, 128, 40);
  EXPECT_GT(differ, 16u);
  EXPECT_FALSE(half.m.misuses.empty());
  for (int n = 0; n < 20; ++n) half.pulse(75);
  EXPECT_EQ(half.cell(kLine), 0x00);  // enough of them do it
  EXPECT_EQ(half.m.flash_control.statistics.blocks[9].weak_pulses, 21);
}

TEST(Flash, PowerCutLeavesPartOfIt) {
  Kernel k;
  k.open();
  k.latch(kLine, 0x00);
  k.put(kFlmcr2, 1);
  k.wait(50);
  k.put(kFlmcr1, 0x41);
  k.wait(80);
  k.m.power_on(0xa5);
  unsigned zeros = 0;
  for (std::uint32_t n = 0; n < 32; ++n)
    zeros += 8u - static_cast<unsigned>(std::popcount(k.cell(kLine + n)));
  EXPECT_GT(zeros, 60u);
  EXPECT_LT(zeros, 200u);
  EXPECT_FALSE(k.m.flash_control.enabled());
}

TEST(Flash, ReadUnderThePulseLocksUntilReset) {
  Kernel k;
  k.open();
  k.latch(kLine, 0x00);
  k.put(kFlmcr2, 1);
  k.wait(50);
  k.put(kFlmcr1, 0x41);
  k.wait(200);
  EXPECT_TRUE(k.m.flash_control.busy());
  k.m.flash_control.read(k.m, 0x1000, k.cell(0x1000), k.m.time());
  EXPECT_EQ(k.get(kFlmcr2), 0x80);
  EXPECT_EQ(k.get(kFlmcr1), 0xc0);
  k.put(kFlmcr2, 1);
  EXPECT_EQ(k.get(kFlmcr2), 0x80);
  k.m.reset(ResetCause::pin, k.m.time());
  k.put(0xffffc3, 0x08);
  EXPECT_EQ(k.get(kFlmcr2), 0x00);
}

TEST(Flash, OneBlockAtATime) {
  Kernel k;
  *k.m.memory_at(0x400) = 0;
  *k.m.memory_at(0x800) = 0;
  k.open();
  k.erase(0, 0x06, 10'000);
  EXPECT_EQ(k.cell(0x400), 0);
  EXPECT_FALSE(k.m.misuses.empty());
  k.erase(0, 0x02, 10'000);
  EXPECT_EQ(k.cell(0x400), 0xff);
  EXPECT_EQ(k.cell(0x800), 0);
}

// A program in flash that starts a pulse fetches from flash: error protection at once.
TEST(Flash, CodeInFlashCannotProgram) {
  Program p;
  p.out8(0xffffc3, 0x08).out8(kFlmcr1, 0x40).out8(kFlmcr2, 0x01).out8(kFlmcr1, 0x41).stay();
  Chip chip = make_chip(p);
  chip.run_until(200);
  EXPECT_EQ(chip.peek(kFlmcr2), 0x80);
  EXPECT_EQ(chip.peek(kFlmcr1), 0xc0);
  EXPECT_EQ(chip.flash_statistics().errors, 1);
}

// The CPU's own reads, from RAM: garbage and FLER.
TEST(Flash, CpuReadUnderThePulse) {
  Program p;
  p.out8(0xffffc3, 0x08).out8(kFlmcr1, 0x40).out8(kFlmcr2, 0x01).out8(kFlmcr1, 0x41);
  p.in8(0x1000).stay();
  Chip chip = make_chip(Program().stay());
  std::uint32_t at = kRamData;
  for (const std::uint16_t w : p.get()) {
    ASSERT_TRUE(chip.poke(at++, static_cast<std::uint8_t>(w >> 8)));
    ASSERT_TRUE(chip.poke(at++, static_cast<std::uint8_t>(w)));
  }
  Registers r = chip.registers();
  r.pc = kRamData;
  chip.set_registers(r);
  chip.run_until(200);
  EXPECT_EQ(chip.peek(kFlmcr2), 0x80);
  EXPECT_NE(chip.registers().er[0] & 0xff, chip.peek(0x1000).value());
}

TEST(Flash, WearIsCounted) {
  Kernel k;
  k.open();
  for (int n = 0; n < 101; ++n) k.erase(0, 0x01, 10'000);
  EXPECT_EQ(k.m.flash_control.statistics.blocks[0].erasures, 101);
  ASSERT_EQ(k.m.misuses.size(), 1u);
  EXPECT_NE(k.m.misuses[0].text.find("endurance"), std::string::npos);
}

}  // namespace
}  // namespace kaz::h8s::testing
