// Each engine where instructions end: the last unit of a memory, block moves that are interrupted.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

class Edges : public ::testing::TestWithParam<Engine> {
 protected:
  static Options options() {
    Options chosen;
    chosen.engine = GetParam();
    chosen.translate_after = 1;
    return chosen;
  }
  static void put(Chip& chip, std::uint32_t at, const std::vector<std::uint16_t>& units) {
    for (const std::uint16_t unit : units) {
      ASSERT_TRUE(chip.poke(at++, static_cast<std::uint8_t>(unit >> 8)));
      ASSERT_TRUE(chip.poke(at++, static_cast<std::uint8_t>(unit)));
    }
  }
  static bool translates() { return GetParam() == Engine::translator && translator_available(); }
};

INSTANTIATE_TEST_SUITE_P(Engines, Edges,
                         ::testing::Values(Engine::reference, Engine::interpreter,
                                           Engine::translator),
                         [](const auto& engine) { return name_of(engine.param); });

struct Memory {
  std::uint32_t end;  // the first address behind it
  const char* name;
};
constexpr Memory kMemories[] = {{0x20000, "flash"}, {0xfff000, "RAM"}, {0xffff80, "short RAM"}};

// Four inc.w #1,r0 at the very end: they run, twice, and the chip stops behind them.
TEST_P(Edges, CodeRunsToTheEndOfItsMemoryAndStopsThere) {
  for (const Memory& memory : kMemories) {
    Chip chip = make_chip(std::vector<std::uint16_t>{}, options());
    put(chip, memory.end - 8, {0x0b50, 0x0b50, 0x0b50, 0x0b50});
    for (int turn = 0; turn < 2; ++turn) {
      if (turn == 1) chip.reset();
      Registers r = chip.registers();
      r.er = {};
      r.pc = memory.end - 8;
      chip.set_registers(r);
      const States start = chip.now();
      const Stop stop = chip.run_until(start + 100);
      EXPECT_EQ(stop.reason, Stop::Reason::undefined_instruction) << memory.name;
      EXPECT_EQ(chip.registers().er[0], 4u) << memory.name;
      EXPECT_EQ(chip.registers().pc, memory.end) << memory.name;
    }
    if (translates()) {
      EXPECT_GE(chip.translated_instructions(), 4) << memory.name;
    }
  }
}

// mov.w #,r1 whose immediate would be past the end: not an instruction.
TEST_P(Edges, AnInstructionCutByTheEndDoesNotRun) {
  for (const Memory& memory : kMemories) {
    Chip chip = make_chip(std::vector<std::uint16_t>{}, options());
    put(chip, memory.end - 4, {0x0b50, 0x7901});
    Registers r = chip.registers();
    r.er = {};
    r.pc = memory.end - 4;
    chip.set_registers(r);
    const Stop stop = chip.run_until(chip.now() + 100);
    EXPECT_EQ(stop.reason, Stop::Reason::undefined_instruction) << memory.name;
    EXPECT_EQ(chip.registers().er[0], 1u) << memory.name;
    EXPECT_EQ(chip.registers().er[1], 0u) << memory.name;
    EXPECT_EQ(chip.registers().pc, memory.end - 2) << memory.name;
  }
}

// A hot loop whose exit is past the end.
TEST_P(Edges, ALoopLeavesOverTheEnd) {
  Chip chip = make_chip(std::vector<std::uint16_t>{}, options());
  // dec.w #1,r0 ; bne back
  put(chip, 0xfff000 - 4, {0x1b50, 0x46fc});
  Registers r = chip.registers();
  r.er[0] = 200;
  r.pc = 0xfff000 - 4;
  chip.set_registers(r);
  const States start = chip.now();
  const Stop stop = chip.run_until(start + 10'000);
  EXPECT_EQ(stop.reason, Stop::Reason::undefined_instruction);
  EXPECT_EQ(chip.registers().er[0] & 0xffff, 0u);
  EXPECT_EQ(chip.registers().pc, 0xfff000u);
  if (translates()) {
    EXPECT_GT(chip.translated_instructions(), 300);
  }
}

// Odd addresses of jumps and returns are the even ones below.
TEST_P(Edges, JumpsToOddAddressesGoToTheEvenOnesBelow) {
  // mov.l #target+1,er1 ; jsr @er1 ; bra .   target: inc.w #1,r0 ; rts
  Chip chip = make_chip({0x7a01, 0x0000, kCode + 12 + 1, 0x5d10, 0x40fe, 0x0000, 0x0b50, 0x5470},
                        options());
  for (std::uint32_t turn = 1; turn <= 3; ++turn) {
    Registers r = chip.registers();
    r.pc = kCode;
    chip.set_registers(r);
    EXPECT_EQ(chip.run_until(chip.now() + 60).reason, Stop::Reason::reached);
    EXPECT_EQ(chip.registers().er[0], turn);
    EXPECT_EQ(chip.registers().pc, kCode + 8);
  }
  if (translates()) {
    EXPECT_GT(chip.translated_instructions(), 10);
  }
}

// EEPMOV.B goes on to its end whatever is requested.
TEST_P(Edges, AByteCountedBlockMoveIsNotInterrupted) {
  constexpr std::uint32_t kSeen = 0xffe600;
  for (int at = 0; at < 24; ++at) {
    // nop ; eepmov.b ; bra .      NMI: mov.w r4,@aa:16 ; rte
    Chip chip = make_chip({0x0000, 0x7b5c, 0x598f, 0x40fe}, options());
    put(chip, handler(7), {0x6b84, static_cast<std::uint16_t>(kSeen), 0x5670});
    put(chip, kSeen, {0xeeee});
    Registers r = chip.registers();
    r.er = {0, 0, 0, 0, 0x12340009, 0xffe400, 0xffe500, kStack};
    r.pc = kCode;
    chip.set_registers(r);
    chip.set_nmi(true);
    const States start = chip.now();
    EXPECT_EQ(chip.run_until(start + at).reason, Stop::Reason::reached);
    chip.set_nmi(false);
    EXPECT_EQ(chip.run_until(start + 100).reason, Stop::Reason::reached);
    EXPECT_EQ(chip.peek16(kSeen), 0) << at;
    EXPECT_EQ(chip.registers().er[6], 0xffe509u) << at;
    EXPECT_EQ(chip.registers().pc, kCode + 6) << at;
  }
}

// eepmov.w in the usual loop, NMI at each state of it: the handler observes a number of whole bytes
// moved, the rest is moved afterwards, and the time is that of both.
TEST_P(Edges, ABlockMoveIsInterruptedBetweenTwoBytes) {
  constexpr std::uint32_t kFrom = 0xffe400, kTo = 0xffe500, kSeen = 0xffe600;
  constexpr std::uint32_t kBytes = 9;
  std::set<std::uint32_t> rests;
  for (int at = 0; at < 40; ++at) {
    // 1: nop ; eepmov.w ; mov.w r4,r4 ; bne 1 ; inc.w #1,r0 ; bra .
    Chip chip = make_chip({0x0000, 0x7bd4, 0x598f, 0x0d44, 0x46f6, 0x0b50, 0x40fe}, options());
    // NMI: the rest, the addresses and what is stacked are kept; rte.
    // mov.w r4,@aa:16 ; mov.l er5,@aa:16 ; mov.l er6,@aa:16 ; mov.l @er7,er1 ; rte
    put(chip, handler(7),
        {0x6b84, static_cast<std::uint16_t>(kSeen), 0x0100, 0x6b85,
         static_cast<std::uint16_t>(kSeen + 2)});
    put(chip, handler(7) + 10, {0x5a00, 0x9800});
    put(chip, 0x9800,
        {0x0100, 0x6b86, static_cast<std::uint16_t>(kSeen + 6), 0x0100, 0x6971, 0x5670});
    for (std::uint32_t k = 0; k < kBytes + 1; ++k) {
      chip.poke(kFrom + k, static_cast<std::uint8_t>(0x30 + k));
      chip.poke(kTo + k, 0);
    }
    chip.poke(kSeen, 0xee);
    Registers r = chip.registers();
    r.er = {0, 0, 0, 0, 0x12340000 | kBytes, kFrom, kTo, kStack};
    r.pc = kCode;
    chip.set_registers(r);
    chip.set_nmi(true);
    const States start = chip.now();
    EXPECT_EQ(chip.run_until(start + at).reason, Stop::Reason::reached);
    const auto raised = static_cast<std::uint32_t>(chip.now() - start);
    chip.set_nmi(false);
    EXPECT_EQ(chip.run_until(start + 200).reason, Stop::Reason::reached);
    const Registers now = chip.registers();
    ASSERT_EQ(now.er[0], 1u) << at;
    EXPECT_EQ(now.er[4], 0x12340000u) << at;
    EXPECT_EQ(now.er[5], kFrom + kBytes) << at;
    EXPECT_EQ(now.er[6], kTo + kBytes) << at;
    EXPECT_EQ(now.er[7], kStack) << at;
    for (std::uint32_t k = 0; k < kBytes; ++k)
      EXPECT_EQ(chip.peek(kTo + k), 0x30 + k) << at << ", byte " << k;
    EXPECT_EQ(chip.peek(kTo + kBytes), 0) << at;
    // State observed by the handler.
    const std::uint32_t rest = chip.peek16(kSeen).value_or(0xffff);
    ASSERT_LE(rest, kBytes) << at;
    EXPECT_EQ(chip.peek32(kSeen + 2), kFrom + kBytes - rest) << at;
    EXPECT_EQ(chip.peek32(kSeen + 6), kTo + kBytes - rest) << at;
    if (rest != 0 && rest != kBytes) {
      EXPECT_EQ(now.er[1] & 0xffffff, kCode + 6) << at << ": the next instruction is stacked";
    }
    // Taken at the first boundary more than 3 states after it; boundaries are at 5, 7, 9 ...
    const std::uint32_t moved = raised <= 1 ? 0 : (raised + 3 - 5) / 2 + 1;
    EXPECT_EQ(rest, kBytes - std::min(moved, kBytes)) << at;
    rests.insert(rest);
  }
  // Before the first byte and after each, but for the first: run_until ends at boundaries alone, so
  // that NMI cannot come at 2 to 4.
  EXPECT_EQ(rests.size(), kBytes);
}

}  // namespace
}  // namespace kaz::h8s::testing
