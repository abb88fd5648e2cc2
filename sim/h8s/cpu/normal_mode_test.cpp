// Normal mode: 16-bit addresses that wrap, vectors and return addresses of one word, exceptions.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kTop = 0xf000;  // of the stack

// Vectors of one word: 0 to kCode, n to 0x8000 + 16 n, each a `bra .`; `words` at kCode.
Chip normal_chip(const std::vector<std::uint16_t>& words) {
  Options options;
  options.mode = 3;
  Image image;
  Segment all{0, 0, "all", std::vector<std::uint8_t>(0xe000, 0)};
  const auto put = [&](std::uint32_t at, std::uint32_t word) {
    all.bytes[at] = static_cast<std::uint8_t>(word >> 8);
    all.bytes[at + 1] = static_cast<std::uint8_t>(word);
  };
  for (unsigned v = 0; v < 104; ++v) {
    put(2 * v, v == 0 ? kCode : handler(v));
    put(handler(v), 0x40fe);
  }
  for (std::size_t k = 0; k < words.size(); ++k)
    put(kCode + 2 * static_cast<std::uint32_t>(k), words[k]);
  image.segments.push_back(all);
  Chip chip(options);
  EXPECT_TRUE(chip.load(image).has_value());
  chip.power_on();
  Registers r = chip.registers();
  r.er[7] = 0xa5a50000 | kTop;  // bits above 16 are ignored
  chip.set_registers(r);
  return chip;
}

TEST(NormalMode, ResetVectorIsOneWord) {
  EXPECT_EQ(normal_chip({0}).registers().pc, kCode);
}

// JSR @@aa:8, BSR, JSR @aa:24, JSR @ERn stack one word; RTS takes it back.
TEST(NormalMode, EveryCallStacksOneWordAndReturns) {
  struct Call {
    std::vector<std::uint16_t> words;
    std::uint32_t to;
    int states;
  };
  const Call calls[] = {{{0x5550}, kCode + 0x52, 3},           // bsr d:8
                        {{0x5c00, 0x0100}, kCode + 0x104, 4},  // bsr d:16
                        {{0x5d20}, 0x2000, 3},                 // jsr @er2
                        {{0x5e12, 0x2000}, 0x2000, 4},         // jsr @0x122000
                        {{0x5f14}, handler(10), 4}};           // jsr @@0x14: vector 10
  for (const Call& call : calls) {
    Chip chip = normal_chip(call.words);
    chip.poke(call.to, std::vector<std::uint8_t>{0x54, 0x70});
    Registers r = chip.registers();
    r.er[2] = 0xbeef2000;
    chip.set_registers(r);
    States before = chip.now();
    ASSERT_EQ(chip.step().reason, Stop::Reason::reached);
    EXPECT_EQ(chip.now() - before, call.states);
    EXPECT_EQ(chip.registers().pc, call.to);
    EXPECT_EQ(chip.registers().er[7], 0xa5a50000 + kTop - 2);
    EXPECT_EQ(chip.peek16(kTop - 2), kCode + 2 * call.words.size());
    before = chip.now();
    chip.step();
    EXPECT_EQ(chip.now() - before, 4);
    EXPECT_EQ(chip.registers().pc, kCode + 2 * call.words.size());
    EXPECT_EQ(chip.registers().er[7], 0xa5a50000 + kTop);
  }
}

TEST(NormalMode, JumpThroughMemory) {
  Chip chip = normal_chip({0x5b16});  // jmp @@0x16: vector 11
  const States before = chip.now();
  chip.step();
  EXPECT_EQ(chip.now() - before, 4);
  EXPECT_EQ(chip.registers().pc, handler(11));
}

// Four bytes are stacked: PC, and CCR in both halves of the other word.
TEST(NormalMode, TrapaAndRte) {
  Chip chip = normal_chip({0x5720});
  Registers r = chip.registers();
  r.ccr = 0x2b;
  chip.set_registers(r);
  chip.poke(handler(10), std::vector<std::uint8_t>{0x56, 0x70});
  States before = chip.now();
  chip.step();
  EXPECT_EQ(chip.now() - before, 7);
  EXPECT_EQ(chip.registers().pc, handler(10));
  EXPECT_EQ(chip.registers().ccr, 0xab);
  EXPECT_EQ(chip.peek16(kTop - 2), kCode + 2);
  EXPECT_EQ(chip.peek(kTop - 4), 0x2b);
  before = chip.now();
  chip.step();
  EXPECT_EQ(chip.now() - before, 5);
  EXPECT_EQ(chip.registers().pc, kCode + 2);
  EXPECT_EQ(chip.registers().ccr, 0x2b);
  EXPECT_EQ(chip.registers().er[7], 0xa5a50000 + kTop);
}

// NMI: 3 states to decide, then 7 of exception sequence, one fewer than in advanced mode.
TEST(NormalMode, Interrupt) {
  Chip chip = normal_chip(std::vector<std::uint16_t>(100, 0));
  chip.set_nmi(true);
  chip.run_until(20);
  chip.set_nmi(false);
  const States edge = chip.now();
  const std::uint32_t at = chip.registers().pc;
  ASSERT_TRUE(run_to(chip, handler(7)));
  EXPECT_EQ(chip.now(), edge + 4 + 7);
  EXPECT_EQ(chip.peek16(kTop - 2), at + 8);
  EXPECT_EQ(chip.registers().er[7], 0xa5a50000 + kTop - 4);
}

// Addresses are cut to 16 bits: of data, of the stack, of branches past either end.
TEST(NormalMode, AddressesWrapAt64KiB) {
  // mov.b @(0x2000:16,er1),r0l with ER1 = 12f080: 0x1080.
  Chip chip = normal_chip({0x6e18, 0x2000});
  Registers r = chip.registers();
  r.er[1] = 0x12f080;
  chip.set_registers(r);
  chip.poke(0x1080, std::uint8_t{0x5a});
  chip.step();
  EXPECT_EQ(chip.registers().er[0] & 0xff, 0x5au);

  // bra .-0x7000 from 0x1000: 0xa004.
  chip = normal_chip({0x5800, 0x9000});
  chip.step();
  EXPECT_EQ(chip.registers().pc, 0xa004u);

  // A post-increment carries into the upper half of the register, which does not count.
  chip = normal_chip({0x6c18});  // mov.b @er1+,r0l
  r = chip.registers();
  r.er[1] = 0x0000ff7f;
  chip.set_registers(r);
  chip.step();
  EXPECT_EQ(chip.registers().er[1], 0x0000ff80u);

  // mov.b @aa:8 and @aa:16 reach the top of the 64 KiB.
  chip = normal_chip({0x2810, 0x6a08, 0xff10});
  chip.poke(0xff10, std::uint8_t{0x77});
  chip.step();
  EXPECT_EQ(chip.registers().er[0] & 0xff, 0x77u);
  chip.step();
  EXPECT_EQ(chip.registers().er[0] & 0xff, 0x77u);
}

// The flash ends at 0xdfff; what follows it up to RAM at 0xe080 is nothing.
TEST(NormalMode, MemoryMap) {
  Chip chip = normal_chip({0});
  EXPECT_TRUE(chip.peek(0xdfff).has_value());
  EXPECT_FALSE(chip.peek(0xe000).has_value());
  EXPECT_TRUE(chip.peek(0xe080).has_value());
  EXPECT_TRUE(chip.peek(0xefff).has_value());
  EXPECT_FALSE(chip.peek(0xf000).has_value());
  EXPECT_TRUE(chip.peek(0xff00).has_value());
}

// Only the lower halves of ER5 and ER6 address; the whole registers count up.
TEST(NormalMode, BlockMoveIgnoresUpperHalves) {
  Chip chip = normal_chip({0x7b5c, 0x598f});
  chip.poke(0xe100, std::vector<std::uint8_t>{1, 2, 3, 4});
  Registers r = chip.registers();
  r.er[4] = 4;
  r.er[5] = 0x7777e100;
  r.er[6] = 0x9999e200;
  chip.set_registers(r);
  const States before = chip.now();
  chip.step();
  EXPECT_EQ(chip.now() - before, 4 + 2 * 4);
  EXPECT_EQ(chip.peek32(0xe200), 0x01020304u);
  EXPECT_EQ(chip.registers().er[5], 0x7777e104u);
  EXPECT_EQ(chip.registers().er[6], 0x9999e204u);
}

}  // namespace
}  // namespace kaz::h8s::testing
