// When interrupts are taken, in which order, and what holds them off.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kIer = 0xffffc2, kIscrl = 0xfffeed, kIcra = 0xfffee8, kSyscr = 0xffffc4;

// IRQ0 (P42) and IRQ1 (P41) on falling edges, enabled, interrupts on, then nops of one state each.
Program irq_program() {
  Program p;
  p.out8(kIscrl, 0x05).out8(kIer, 0x03).enable_interrupts();
  return p;
}

Chip with_pins_high(const Program& p) {
  Chip chip = make_chip(p);
  chip.set_input(Port::p4, 2, true);
  chip.set_input(Port::p4, 1, true);
  return chip;
}

// A request is taken at the first boundary later than 3 states after it: nops end at each state, so
// the handler's first instruction can begin 4 + 8 states after the edge, and not at 3 + 8.
TEST(Interrupts, AreTakenAfterTheDecisionTime) {
  Program p = irq_program();
  const std::uint32_t nops = end_of(p);
  p.nops(100);
  Chip chip = with_pins_high(p);
  ASSERT_TRUE(run_to(chip, nops + 20));
  chip.set_input(Port::p4, 2, false);
  const States edge = chip.now();
  Stop stop = chip.run_until(edge + 3);
  EXPECT_EQ(chip.registers().pc, nops + 26);  // three nops further, not taken yet
  stop = chip.run_until(edge + 4);
  EXPECT_EQ(chip.registers().pc, nops + 28);
  chip.step();  // the exception sequence
  EXPECT_EQ(chip.now(), edge + 4 + 8);
  EXPECT_EQ(chip.registers().pc, handler(16));
  EXPECT_EQ(chip.peek32(kStack - 4).value() & 0xffffff, nops + 28);
  EXPECT_TRUE(chip.registers().ccr & 0x80);
}

// The longest instruction, DIVXS.W (21 states), just begun: 3 + 21 + 8 = 32 at most in advanced
// mode.
TEST(Interrupts, WaitForTheInstruction) {
  Program p = irq_program();
  const std::uint32_t nops = end_of(p);
  p.nops(3);
  for (int k = 0; k < 4; ++k) p.words({0x01d0, 0x5310});
  Chip chip = with_pins_high(p);
  ASSERT_TRUE(run_to(chip, nops));
  chip.set_input(Port::p4, 2, false);
  const States edge = chip.now();
  ASSERT_TRUE(run_to(chip, handler(16)));
  EXPECT_EQ(chip.now() - edge, 3 + 21 + 8);
}

TEST(Interrupts, MaskedByI) {
  Program p;
  p.out8(kIscrl, 0x05).out8(kIer, 0x03).nops(50).stay();
  Chip chip = with_pins_high(p);
  chip.run_until(30);
  chip.set_input(Port::p4, 2, false);
  chip.run_until(300);
  EXPECT_EQ(chip.registers().pc, end_of(p) - 2);
}

TEST(Interrupts, EdgeFlagSetsWithoutEnableAndClearsOnlyAfterReadingOne) {
  // isr := 0 without a read has no effect; after a read it clears.
  Program p;
  p.out8(kIscrl, 0x05).nops(20).out8(0xfffeeb, 0x00).in8(0xfffeeb).out8(0xfffeeb, 0x00).stay();
  Chip chip = with_pins_high(p);
  chip.run_until(10);
  chip.set_input(Port::p4, 2, false);
  const std::uint32_t first_write_done = end_of(p) - 2 - 6 - 4;
  ASSERT_TRUE(run_to(chip, first_write_done));
  EXPECT_EQ(chip.peek(0xfffeeb).value() & 1, 1);
  ASSERT_TRUE(run_to(chip, end_of(p) - 2));
  EXPECT_EQ(chip.peek(0xfffeeb).value() & 1, 0);
}

// Both at once: the lower vector first, unless the other one has its ICR bit.
TEST(Interrupts, PriorityByVectorThenByIcr) {
  for (const bool raised : {false, true}) {
    Program p;
    p.out8(kIscrl, 0x05).out8(kIer, 0x03).out8(kIcra, raised ? 0x40 : 0x00);
    const std::uint32_t masked = end_of(p);
    p.nops(20).enable_interrupts().nops(10).stay();
    Chip chip = with_pins_high(p);
    ASSERT_TRUE(run_to(chip, masked));
    chip.set_input(Port::p4, 2, false);
    chip.set_input(Port::p4, 1, false);
    ASSERT_TRUE(run_to(chip, handler(raised ? 17 : 16)));
  }
}

// Control mode 1: UI = 0 lets sources with ICR = 1 through I = 1; entry sets UI.
TEST(Interrupts, ControlModeOneHasThreeLevels) {
  for (const std::uint8_t icra : {0x00, 0x80}) {
    Program p;
    p.out8(kSyscr, 0x19).out8(kIscrl, 0x05).out8(kIer, 0x01).out8(kIcra, icra);
    p.words({0x0780});  // ldc #0x80,ccr: I = 1, UI = 0
    const std::uint32_t ready = end_of(p);
    p.nops(20).stay();
    Chip chip = with_pins_high(p);
    ASSERT_TRUE(run_to(chip, ready));
    chip.set_input(Port::p4, 2, false);
    chip.run_until(chip.now() + 60);
    EXPECT_EQ(chip.registers().pc, icra ? handler(16) : end_of(p) - 2);
    EXPECT_EQ(chip.registers().ccr & 0xc0, icra ? 0xc0 : 0x80);
  }
}

// After ANDC one more instruction runs before a waiting request is taken.
TEST(Interrupts, HeldOffAfterAndc) {
  Program p;
  p.out8(kIscrl, 0x05).out8(kIer, 0x01);
  const std::uint32_t masked = end_of(p);
  p.nops(10).enable_interrupts();
  const std::uint32_t after = end_of(p);
  p.nops(10);
  Chip chip = with_pins_high(p);
  ASSERT_TRUE(run_to(chip, masked));
  chip.set_input(Port::p4, 2, false);
  ASSERT_TRUE(run_to(chip, handler(16)));
  EXPECT_EQ(chip.peek32(kStack - 4).value() & 0xffffff, after + 2);
}

TEST(Interrupts, NmiIgnoresTheMask) {
  Program p;
  p.nops(50);
  Chip chip = make_chip(p);
  chip.run_until(10);
  chip.set_nmi(false);
  ASSERT_TRUE(run_to(chip, handler(7)));
  EXPECT_EQ(chip.now(), 10 + 4 + 8);
}

// EEPMOV.W is left between two bytes with the next instruction stacked; EEPMOV.B is not left.
TEST(Interrupts, BlockMoveByWordCountIsInterruptible) {
  for (const bool word : {false, true}) {
    Program p = irq_program();
    const std::uint32_t at = end_of(p);
    p.words({static_cast<std::uint16_t>(word ? 0x7bd4 : 0x7b5c), 0x598f}).stay();
    Chip chip = with_pins_high(p);
    ASSERT_TRUE(run_to(chip, at));
    Registers r = chip.registers();
    r.er[4] = 200;
    r.er[5] = kRamData;
    r.er[6] = kRamData + 0x300;
    chip.set_registers(r);
    chip.run_until(chip.now() + (word ? 50 : 0));
    chip.set_input(Port::p4, 2, false);
    ASSERT_TRUE(run_to(chip, handler(16)));
    EXPECT_EQ(chip.peek32(kStack - 4).value() & 0xffffff, at + 4);
    if (word)
      EXPECT_GT(chip.registers().er[4], 100u);
    else
      EXPECT_EQ(chip.registers().er[4], 0u);
  }
}

TEST(Sleep, JumpsToTheInterruptAndStacksTheNextInstruction) {
  Program p = irq_program();
  p.word(0x0180);
  const std::uint32_t behind = end_of(p);
  p.stay();
  Chip chip = with_pins_high(p);
  EXPECT_EQ(chip.run_until(100'000).reason, Stop::Reason::reached);
  EXPECT_TRUE(chip.asleep());
  EXPECT_EQ(chip.now(), 100'000);
  chip.set_input(Port::p4, 2, false);
  ASSERT_TRUE(run_to(chip, handler(16)));
  EXPECT_EQ(chip.now(), 100'000 + 4 + 8);
  EXPECT_EQ(chip.peek32(kStack - 4).value() & 0xffffff, behind);
}

TEST(Sleep, WithEverythingOffIsReported) {
  Program p;
  p.word(0x0180).stay();
  Chip chip = make_chip(p);
  const Stop stop = chip.run_until(1000);
  EXPECT_EQ(stop.reason, Stop::Reason::asleep_forever);
  EXPECT_NE(stop.report.find("SLEEP"), std::string::npos);
}

}  // namespace
}  // namespace kaz::h8s::testing
