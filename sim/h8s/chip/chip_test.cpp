// The chip as a whole: snapshots, hooks, calls, ports, errors, and images full of nonsense.
// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/translate/available.h"

namespace kaz::h8s::testing {
namespace {

// FRT interrupts, serial bytes and A/D all at work, so that a snapshot has something to forget.
Program busy_program() {
  Program p;
  p.modules_on().out8(0xffffd9, 4).out8(0xffffda, 0x70).out16(0xffff94, 99).out8(0xffff91, 0x01);
  p.out8(0xffff90, 0x09).out8(0xffffe8, 0x3b).out8(0xffffc8, 0x09).out8(0xffffca, 0x03);
  p.enable_interrupts();
  const std::uint32_t loop = end_of(p);
  p.words({0x0b70, 0x0f81, 0x5210});  // inc.l #1,er0 ; mov.l er0,er1 ; mulxu.w r1,er0
  p.word(static_cast<std::uint16_t>(0x4000 | ((loop - end_of(p) - 2) & 0xff)));
  return p;
}

Chip busy_chip() {
  Chip chip = make_chip(busy_program());
  chip.poke(handler(52), std::vector<std::uint8_t>{0x7f, 0x91, 0x72, 0x30, 0x56, 0x70});
  chip.poke(handler(81), std::vector<std::uint8_t>{0x7f, 0xdc, 0x72, 0x60, 0x56, 0x70});
  chip.set_analog([](int channel, States) { return channel / 8.0; });
  for (States k = 1; k < 10; ++k)
    EXPECT_TRUE(chip.receive(0, {static_cast<std::uint8_t>(k), 3000 * k}).has_value());
  return chip;
}

void expect_same(const Chip& a, const Chip& b) {
  EXPECT_EQ(a.now(), b.now());
  EXPECT_EQ(a.instructions(), b.instructions());
  EXPECT_EQ(a.registers(), b.registers());
  for (std::uint32_t at = 0xffe080; at < 0x1000000; ++at)
    ASSERT_EQ(a.peek(at), b.peek(at)) << std::hex << at;
}

TEST(Snapshot, GoesOnAsIfNothingHadHappened) {
  Chip straight = busy_chip(), split = busy_chip();
  straight.run_until(40'000);
  const auto saved = [&] {
    split.run_until(12'345);
    return split.save();
  }();
  split.run_until(30'000);
  split.restore(*saved);
  for (States at = 12'400; at <= 40'000; at += 37) split.run_until(at);
  split.run_until(40'000);
  expect_same(straight, split);
}

// Episodes begin again by the thousand: translating anew would cost more than they do.
TEST(Snapshot, KeepsTranslatedCodeOfTheSameFlash) {
  Chip chip = busy_chip();
  chip.run_until(100'000);
  const auto saved = chip.save();
  const auto translated = [&](States until) {
    const std::int64_t before = chip.translated_instructions();
    chip.run_until(until);
    return chip.translated_instructions() - before;
  };
  const std::int64_t after = translated(101'000);
  EXPECT_EQ(after > 20, translator_available());
  chip.restore(*saved);
  EXPECT_EQ(translated(101'000), after);
}

TEST(Snapshot, ForgetsCodeOfAnotherFlash) {
  Chip chip = busy_chip();
  chip.run_until(100'000);
  const auto saved = chip.save();
  chip.run_until(110'000);
  Chip straight = chip.clone();
  chip.restore(*saved);
  chip.poke(handler(52), std::vector<std::uint8_t>{0x56, 0x70});
  chip.run_until(110'000);
  EXPECT_NE(chip.registers().er, straight.registers().er);
  chip.restore(*saved);
  chip.run_until(110'000);
  expect_same(chip, straight);
}

TEST(Snapshot, CloneIsIndependent) {
  Chip chip = busy_chip();
  chip.run_until(5'000);
  Chip copy = chip.clone();
  copy.set_analog([](int channel, States) { return channel / 8.0; });
  copy.poke(kRamData, 0x5a);
  EXPECT_NE(chip.peek(kRamData), copy.peek(kRamData));
  copy.poke(kRamData, chip.peek(kRamData).value());
  chip.run_until(9'000);
  copy.run_until(9'000);
  expect_same(chip, copy);
}

TEST(Hooks, CallBackEachTimeAndCostNoTime) {
  Chip plain = busy_chip(), hooked = busy_chip();
  int calls = 0;
  hooked.set_hook(handler(52), [&](Chip& c) {
    EXPECT_EQ(c.registers().pc, handler(52));
    ++calls;
    return HookAction::go_on;
  });
  plain.run_until(20'000);
  hooked.run_until(20'000);
  EXPECT_GT(calls, 90);
  expect_same(plain, hooked);
  hooked.clear_hook(handler(52));
  calls = 0;
  hooked.run_until(22'000);
  EXPECT_EQ(calls, 0);
}

TEST(Hooks, BreakpointStopsBeforeTheInstructionAndGoesOn) {
  Chip chip = make_chip(Program().nops(3).stay());
  chip.set_breakpoint(kCode + 4);
  EXPECT_EQ(chip.run_until(1000).reason, Stop::Reason::breakpoint);
  EXPECT_EQ(chip.registers().pc, kCode + 4);
  EXPECT_EQ(chip.now(), 2);
  EXPECT_EQ(chip.run_until(1000).reason, Stop::Reason::reached);
}

TEST(Call, RunsAFunctionOnAClone) {
  // add.l er1,er0 ; add.l er2,er0 ; rts
  Chip chip = make_chip({0x0a90, 0x0aa0, 0x5470});
  Chip copy = chip.clone();
  const auto result = copy.call(kCode, {1000, 200, 30});
  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_EQ(result->er0, 1230u);
  EXPECT_EQ(result->states, 1 + 1 + 5);
  EXPECT_TRUE(copy.call(kCode, {1, 2, 3}).has_value());
  EXPECT_EQ(chip.now(), 0);
  const auto endless = chip.clone().call(handler(9), {}, 500);
  ASSERT_FALSE(endless.has_value());
  EXPECT_NE(endless.error().message.find("500"), std::string::npos);
}

TEST(Ports, ReadMixesLatchAndPins) {
  Program p;
  p.out8(0xffffb4, 0xf0).out8(0xffffb6, 0xa5).in8(0xffffb6).stay();
  Chip chip = make_chip(p);
  for (int bit = 0; bit < 8; ++bit) chip.set_input(Port::p3, bit, bit == 1);
  chip.run_until(50);
  EXPECT_EQ(chip.registers().er[0] & 0xff, 0xa2u);
  EXPECT_EQ(chip.output(Port::p3), (PortOutput{0xa0, 0xf0}));
}

TEST(Ports, ChangesAreReportedWithTheirState) {
  Program p;
  p.out8(0xffffb4, 0xff).out8(0xffffb6, 0x01).out8(0xffffb6, 0x01).out8(0xffffb6, 0x03).stay();
  Chip chip = make_chip(p);
  std::vector<OutputChange> changes;
  chip.on_output([&](const OutputChange& c) { changes.push_back(c); });
  chip.run_until(50);
  ASSERT_EQ(changes.size(), 3u);  // the repeated value is no change
  EXPECT_EQ(changes[0].at, 5);    // mov.b # 1, mov.b @aa:16 to a register 4
  EXPECT_EQ(changes[1].at, 10);
  EXPECT_EQ(changes[2].at, 20);
  EXPECT_EQ(changes[1].index, 3);
}

TEST(Ports, PullUpsAndDataDirectionReads) {
  Program p;
  p.out8(0xffffac, 0x0f).in8(0xffffb2).stay();
  Chip chip = make_chip(p);
  chip.set_input(Port::p1, 0, false);
  chip.run_until(30);
  EXPECT_EQ(chip.registers().er[0] & 0xff, 0x0eu);
  Chip forbidden = make_chip(Program().in8(0xffffb0).stay());
  forbidden.run_until(30);
  ASSERT_EQ(forbidden.misuse().size(), 1u);
  EXPECT_EQ(forbidden.registers().er[0] & 0xff, 0xffu);
}

TEST(Errors, StopWithAReport) {
  struct Case {
    std::vector<std::uint16_t> words;
    Stop::Reason reason;
    const char* text;
  };
  const Case cases[] = {
      {{0x0001}, Stop::Reason::undefined_instruction, "undefined instruction"},
      {{0x0160, 0x6d10}, Stop::Reason::undefined_instruction, "undefined"},  // MAC: H8S/2600 only
      {{0x6a08, 0x7000}, Stop::Reason::reached, ""},
      {{0x6a28, 0x0002, 0x0000}, Stop::Reason::unmapped_access, "0x020000"},
      {{0x6aa8, 0x00ff, 0xf000}, Stop::Reason::unmapped_access, "0xfff000"},
      {{0x7a07, 0x0000, 0x4000, 0x0100, 0x6df0}, Stop::Reason::stack_outside_ram, "stack"},
      {{0x5a02, 0x0000}, Stop::Reason::undefined_instruction, "fetch"},
  };
  for (const Case& c : cases) {
    Chip chip = make_chip(c.words);
    Stop stop;
    for (int k = 0; k < 3 && stop.reason == Stop::Reason::reached; ++k) stop = chip.step();
    if (c.reason == Stop::Reason::reached) continue;
    EXPECT_EQ(stop.reason, c.reason) << stop.report;
    EXPECT_NE(stop.report.find(c.text), std::string::npos) << stop.report;
    EXPECT_NE(stop.report.find("ER7"), std::string::npos);
    EXPECT_EQ(chip.run_until(chip.now() + 100).reason, c.reason);  // until reset
    chip.reset();
    EXPECT_EQ(chip.registers().pc, kCode);
  }
}

TEST(Errors, OddWordIsReportedAndTakenAsEven) {
  Chip chip = make_chip({0x6910, 0x40fe});
  chip.poke(kRamData, std::vector<std::uint8_t>{0x12, 0x34});
  Registers r = chip.registers();
  r.er[1] = kRamData + 1;
  chip.set_registers(r);
  chip.step();
  EXPECT_EQ(chip.registers().er[0] & 0xffff, 0x1234u);
  ASSERT_EQ(chip.misuse().size(), 1u);
  EXPECT_EQ(chip.misuse()[0].pc, kCode);
}

// 60 images of random bytes and 60 damaged programs: any stop will do, and the same one twice.
TEST(Hostile, RandomImagesNeverCrash) {
  std::mt19937 random(7);
  for (int round = 0; round < 120; ++round) {
    const auto build = [&](std::uint32_t seed) {
      std::mt19937 r(seed);
      Chip chip = busy_chip();
      if (round % 2 == 0) {
        for (std::uint32_t at = 0x400; at < 0x9000; ++at)
          chip.poke(at, static_cast<std::uint8_t>(r()));
        for (std::uint32_t at = 0xffe080; at < 0xfff000; ++at)
          chip.poke(at, static_cast<std::uint8_t>(r()));
      } else {
        for (int k = 0; k < 8; ++k) {
          const std::uint32_t at = kCode + r() % (2 * busy_program().get().size());
          chip.poke(at, static_cast<std::uint8_t>(chip.peek(at).value() ^ (1u << r() % 8)));
        }
      }
      return chip;
    };
    const auto seed = static_cast<std::uint32_t>(random());
    Chip one = build(seed), two = build(seed);
    for (States at = 0; at < 60'000; at += 20'000) {
      const Stop a = one.run_until(at), b = two.run_until(at);
      ASSERT_EQ(a.reason, b.reason);
      ASSERT_EQ(one.registers(), two.registers());
    }
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
