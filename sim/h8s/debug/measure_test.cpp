// Profile, stack, coverage, uninitialised RAM and trace of a guest whose states are added by hand.
// SPDX-License-Identifier: Apache-2.0
#include <sstream>

#include "sim/h8s/debug/coverage.h"
#include "sim/h8s/debug/debug_testing.h"
#include "sim/h8s/debug/memory_checks.h"
#include "sim/h8s/debug/profile.h"
#include "sim/h8s/debug/trace.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kTwice = 0x1020, kLeaf = 0x1030;

// States from the CPU manual's table of instruction states, advanced mode, on-chip memory:
// jsr @aa:24 5, bsr d:8 4, rts 5, nop 1, bra 2.
Chip guest() {
  std::vector<std::uint16_t> words(0x20, 0);
  const auto put = [&](std::uint32_t at, std::initializer_list<std::uint16_t> code) {
    std::copy(code.begin(), code.end(), words.begin() + (at - kCode) / 2);
  };
  put(kCode, {0x5e00, 0x1020, 0x5e00, 0x1020, 0x40fe});  // jsr twice, jsr twice, bra .
  put(kTwice, {0x550e, 0x550c, 0x5470});                 // bsr leaf, bsr leaf, rts
  put(kLeaf, {0x0000, 0x5470});                          // nop, rts
  Chip chip = make_chip(words);
  chip.set_symbols(SymbolTable(
      {{"_main", kCode, true}, {"_twice", kTwice, true}, {"_leaf", kLeaf, true}},
      {{kCode, "a.c", 10}, {kTwice, "a.c", 20}, {kLeaf, "a.c", 30}, {kLeaf + 2, "a.c", 31}}));
  return chip;
}

TEST(Profile, StatesByHand) {
  Chip chip = guest();
  Profile profile(chip, ProfileWindow{kTwice, kTwice + 4});
  chip.attach(profile);
  chip.run_until(5 + 25 + 5 + 25);
  ASSERT_EQ(chip.now(), 60);
  const auto f = profile.functions();
  ASSERT_EQ(f.size(), 3u);
  EXPECT_EQ(f[0].name, "_twice");
  EXPECT_EQ(f[0].calls, 2);
  EXPECT_EQ(f[0].self, 2 * (4 + 4 + 5));
  EXPECT_EQ(f[0].with_callees, 2 * (4 + 4 + 5 + 2 * 6));
  EXPECT_EQ(f[0].worst, 25);
  EXPECT_EQ(f[1].name, "_leaf");
  EXPECT_EQ(f[1].calls, 4);
  EXPECT_EQ(f[1].self, 4 * (1 + 5));
  EXPECT_EQ(f[1].median, 6);
  EXPECT_EQ(f[2].name, "_main");
  EXPECT_EQ(f[2].self, 10);
  EXPECT_EQ(f[2].with_callees, 60);
  EXPECT_EQ(profile.total(), 60);

  const WorstWindow w = profile.worst_window();
  EXPECT_EQ(w.windows, 2);
  EXPECT_EQ(w.worst, 4 + 6 + 4 + 6);
  EXPECT_EQ(w.at, 5);
  ASSERT_EQ(w.functions.size(), 2u);
  EXPECT_EQ(w.functions[0].name, "_leaf");
  EXPECT_EQ(w.functions[0].self, 12);
  EXPECT_EQ(w.functions[1].self, 8);

  const std::string grind = profile.callgrind();
  EXPECT_NE(grind.find("fl=a.c\nfn=_leaf\n0x1030 30 4\n0x1032 31 20\n"), std::string::npos)
      << grind;
  EXPECT_NE(grind.find("cfn=_leaf\ncalls=2 0x1030 30\n0x1020 20 12\n"), std::string::npos) << grind;
  EXPECT_NE(profile.json().find("{\"name\":\"_leaf\",\"address\":4144,\"interrupt\":false,"
                                "\"calls\":4,\"self\":24,\"with_callees\":24,\"median\":6,"
                                "\"worst\":6}"),
            std::string::npos);
  EXPECT_NE(profile.text().find("2 ticks: median 20 states, worst 20 (from state 5)"),
            std::string::npos);
}

TEST(Profile, InterruptsAreFunctionsOfTheirOwn) {
  Chip chip = busy_chip();
  Profile profile(chip);
  chip.attach(profile);
  chip.run_until(20'000);
  States sum = profile.asleep();
  bool seen = false;
  for (const FunctionProfile& f : profile.functions()) {
    sum += f.self;
    if (f.address != handler(52)) continue;
    seen = true;
    EXPECT_TRUE(f.interrupt);
    // 8 of entry; bclr #3,@aa:8 4 and 1 more for each of its two register accesses; rte 5.
    EXPECT_EQ(f.median, 8 + 4 + 2 + 5);
    EXPECT_GT(f.calls, 50);
  }
  EXPECT_TRUE(seen);
  EXPECT_EQ(sum, chip.now());
}

TEST(Profile, TailJumpsAndRecursion) {
  // main: bsr a; bra .   a: bra b (tail)   b: dec.b r0l; beq +2; bsr b; rts
  Program p;
  p.words({0xf803, 0x5502, 0x40fe});          // 1000 mov.b #3,r0l; bsr 1006; bra .
  p.words({0x4000});                          // 1006 a: bra 1008
  p.words({0x1a08, 0x4702, 0x55fa, 0x5470});  // 1008 b
  Chip chip = make_chip(p);
  chip.set_symbols(
      SymbolTable({{"_main", kCode, true}, {"_a", kCode + 6, true}, {"_b", kCode + 8, true}}, {}));
  Profile profile(chip);
  chip.attach(profile);
  ASSERT_TRUE(run_to(chip, kCode + 4));
  for (const FunctionProfile& f : profile.functions()) {
    // dec 1, beq 2, bsr 4, rts 5: twice in full, once without the call.
    const States b = 2 * (1 + 2 + 4 + 5) + (1 + 2 + 5);
    if (f.name == "_b") {
      EXPECT_EQ(f.calls, 3);
      EXPECT_EQ(f.self, b);
      EXPECT_EQ(f.with_callees, b);
      EXPECT_EQ(f.worst, b);
      EXPECT_EQ(f.median, 1 + 2 + 4 + 5 + 1 + 2 + 5);
    }
    if (f.name == "_a") {
      EXPECT_EQ(f.self, 2);
      EXPECT_EQ(f.with_callees, 2 + b);
    }
  }
}

TEST(Stack, DeepestPointAndItsCalls) {
  Chip chip = guest();
  StackMeter stack(chip);
  chip.attach(stack);
  chip.run_until(60);
  EXPECT_EQ(stack.lowest(), kStack - 8);
  EXPECT_EQ(stack.used(), 8u);
  ASSERT_EQ(stack.chain().size(), 3u);
  EXPECT_EQ(stack.chain()[1].function, kTwice);
  EXPECT_EQ(stack.chain()[2].function, kLeaf);
  EXPECT_NE(stack.text().find("8 bytes"), std::string::npos);
}

// Before `mov.l #0xfff000,er7` the pointer leads into flash, which is no stack.
TEST(Stack, BeginsWhereTheProgramSetsIt) {
  Program p;
  p.words({0x7a07, 0x00ff, 0xf000, 0x6df0});  // mov.l #0xfff000,er7 ; push.w r0
  p.stay();
  Chip chip = make_chip(p);
  Registers r = chip.registers();
  r.er[7] = 0;
  chip.set_registers(r);
  StackMeter stack(chip);
  chip.attach(stack);
  chip.run_until(60);
  EXPECT_EQ(stack.lowest(), 0xffeffeu);
  EXPECT_EQ(stack.used(), 2u);
}

TEST(Uninitialised, FirstReadOnceForEachInstruction) {
  Program p;
  p.words({0x6a88, 0xe101});  // mov.b r0l,@0xffe101:16
  const std::uint32_t word = end_of(p);
  p.words({0x6b00, 0xe100});  // mov.w @0xffe100:16,r0: half of it is not written
  p.in8(0xffe101);            // written
  p.words({0x6b01, 0xe200});  // mov.w @0xffe200:16,r1: poked
  const std::uint32_t from = end_of(p) + 2;
  p.word(static_cast<std::uint16_t>(0x4000 | ((word - from) & 0xff)));  // bra word
  Chip chip = make_chip(p);
  UninitialisedReads check(chip);
  chip.attach(check);
  chip.poke(0xffe200, std::vector<std::uint8_t>{1, 2});
  chip.run_until(200);
  ASSERT_EQ(check.reads().size(), 1u);
  EXPECT_EQ(check.reads()[0].address, 0xffe100u);
  EXPECT_EQ(check.reads()[0].pc, word);
  EXPECT_NE(check.text().find("reads uninitialized"), std::string::npos);
}

TEST(Coverage, CountsAndBranches) {
  // mov.b #3,r0l ; dec.b r0l ; bne -4 ; bra .
  Chip chip = make_chip(Program().words({0xf803, 0x1a08, 0x46fc}).stay());
  chip.set_symbols(SymbolTable(
      {{"_main", kCode, true}, {"_never", kCode + 0x40, true}},
      {{kCode, "a.c", 1}, {kCode + 2, "a.c", 2}, {kCode + 6, "a.c", 3}, {kCode + 0x40, "a.c", 9}}));
  Coverage coverage(chip);
  chip.attach(coverage);
  chip.run_until(10);  // 1 + 3 * (1 + 2)
  const auto& counts = coverage.counts();
  ASSERT_EQ(counts.size(), 3u);
  EXPECT_EQ(counts.at(kCode + 2).executed, 3);
  EXPECT_EQ(counts.at(kCode + 4).taken, 2);
  EXPECT_EQ(counts.at(kCode + 4).passed, 1);
  const std::string lcov = coverage.lcov();
  for (const char* line : {"SF:a.c\n", "FNDA:1,_main\n", "FNDA:0,_never\n", "DA:1,1\n", "DA:2,3\n",
                           "DA:3,0\n", "DA:9,0\n", "BRDA:2,4100,0,2\n", "BRDA:2,4100,1,1\n"})
    EXPECT_NE(lcov.find(line), std::string::npos) << line << lcov;
  EXPECT_NE(coverage.text().find("_main"), std::string::npos);
}

// A function's bytes end where the image says so: not with the gap, the constants or the assembly code before
// the next function.
TEST(Coverage, AFunctionsSizeHasNoHoleInIt) {
  // jsr @0x1020 ; bra . ; and at 0x1020, which is no function: nop ; rts
  std::vector<std::uint16_t> words(0x20, 0);
  words[0] = 0x5e00, words[1] = 0x1020, words[2] = 0x40fe, words[0x11] = 0x5470;
  Chip chip = make_chip(words);
  chip.set_symbols(
      SymbolTable({{"_main", kCode, true, 8},
                   {"helper", kCode + 0x20, false},
                   {"_next", kCode + 0x30, true, 0xffffffff},  // of a damaged image
                   {"_unsized", kCode + 0x38, true}},
                  {{kCode, "a.c", 1}, {kCode + 6, "a.c", 2}, {kCode + 0x30, "a.c", 9}}));
  Coverage coverage(chip);
  chip.attach(coverage);
  chip.run_until(20);
  ASSERT_TRUE(coverage.counts().contains(kCode + 0x20)) << "the helper ran";
  const std::string text = coverage.text();
  for (const char* line : {"      6       8    75.0            1         0  _main\n",
                           "      0       8     0.0            0         0  _next\n",
                           "      0       -       -            0         0  _unsized\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  // Nor does the helper run the last line of _main, which nothing does.
  EXPECT_NE(coverage.lcov().find("DA:2,0\n"), std::string::npos) << coverage.lcov();
}

TEST(Trace, LinesAndTheLastOnes) {
  Chip chip = make_chip(Program().words({0x7900, 5, 0x6b80, 0xe100}).stay());
  std::ostringstream out;
  Trace all(chip, out), last(chip, 2);
  chip.attach(all);
  chip.attach(last);
  chip.run_until(9);  // 2 + 4, and bra . of 2 twice
  std::vector<std::string> lines;
  std::istringstream in(out.str());
  for (std::string l; std::getline(in, l);) lines.push_back(l);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_NE(lines[0].find("001000"), std::string::npos);
  EXPECT_NE(lines[0].find("mov.w #0x5,r0"), std::string::npos);
  EXPECT_NE(lines[0].find("er0=00000005"), std::string::npos);
  EXPECT_NE(lines[1].find("           2  001004"), std::string::npos);
  EXPECT_NE(lines[1].find("[ffe100]=0005"), std::string::npos);
  EXPECT_EQ(last.text(), lines[2] + "\n" + lines[3] + "\n");
}

TEST(Snapshot, RestoredAtAnyMomentGoesOnTheSame) {
  // Timer, serial and A/D interrupts around block moves of 40 bytes.
  Program p = busy_program();
  Chip straight = busy_chip();
  const auto patch = [](Chip& chip) {
    // In place of the loop's mulxu: eepmov.w would not fit, so the receive handler does it.
    chip.poke(handler(81), std::vector<std::uint8_t>{0x5a, 0x00, 0x90, 0x00});
    chip.poke(0x9000, std::vector<std::uint8_t>{
                          0x7f, 0xdc, 0x72, 0x60, 0x06, 0x7f,  // bclr ; andc #7f,ccr
                          0x79, 0x04, 0x00, 0x28, 0x7a, 0x05, 0,    0xff, 0xe1, 0x00, 0x7a,
                          0x06, 0,    0xff, 0xe2, 0x00, 0x7b, 0xd4, 0x59, 0x8f, 0x56, 0x70});
  };
  patch(straight);
  straight.run_until(16'000);
  Chip walking = busy_chip(), other = busy_chip();
  patch(walking);
  for (States at = 13; at < 16'000; at += 61) {
    walking.run_until(at);
    other.restore(*walking.save());
    std::swap(walking, other);
    walking.set_analog([](int channel, States) { return channel / 8.0; });
  }
  walking.run_until(16'000);
  expect_same(straight, walking);
}

}  // namespace
}  // namespace kaz::h8s::testing
