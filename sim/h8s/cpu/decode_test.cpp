// Which words are instructions, and how long: the decoder against the tests' own instruction list.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/cpu/opcode.h"
#include "sim/h8s/cpu/oracle_model_testing.h"

namespace kaz::h8s::oracle {
namespace {

struct Tally {
  int defined = 0, undefined = 0, wrong = 0;
};

void compare(std::span<const u16> units, Tally& tally) {
  const Form* form = find(units);
  const Decoded decoded = decode(units, false);
  const int length = decoded.opcode ? decoded.insn.units : 0;
  const int wanted = form ? form->units() : 0;
  ++(form ? tally.defined : tally.undefined);
  if (length == wanted || ++tally.wrong > 20) return;
  ADD_FAILURE() << std::hex << units[0] << ' ' << units[1] << ' ' << units[2] << ": " << length
                << " units, not " << wanted << (form ? " of " + form->name : std::string());
}

// Words that may follow a first word, so that every form is reached.
TEST(Decode, EveryFirstWord) {
  static constexpr u16 kSecond[] = {0x0000, 0xffff, 0x598f, 0x7008, 0x7300, 0x67f0, 0x6000,
                                    0x6b20, 0x6aa0, 0x6930, 0x6df0, 0x6d71, 0x1234, 0x6411};
  Tally tally;
  for (u32 first = 0; first < 0x10000; ++first) {
    for (const u16 second : kSecond) {
      const std::array<u16, 5> units{static_cast<u16>(first), second, 0x7230, 0x6b20, 0x0010};
      compare(units, tally);
    }
  }
  EXPECT_GT(tally.undefined, 100'000);
  EXPECT_GT(tally.defined, 500'000);
}

// Behind each first word that is only the beginning of an instruction: all second words.
TEST(Decode, EverySecondWordBehindAPrefix) {
  std::vector<u16> prefixes{0x7c30, 0x7d50, 0x7ec1, 0x7f34, 0x7b5c, 0x7bd4, 0x7830, 0x78c0};
  for (u16 low = 0; low < 0x100; low += 0x10) prefixes.push_back(static_cast<u16>(0x0100 | low));
  for (const u16 word : {0x0141, 0x0111, 0x01f1, 0x01c8})
    prefixes.push_back(static_cast<u16>(word));
  Tally tally;
  for (const u16 first : prefixes) {
    for (u32 second = 0; second < 0x10000; ++second) {
      const std::array<u16, 5> units{first, static_cast<u16>(second), 0x6ba3, 0x0012, 0x3456};
      compare(units, tally);
    }
  }
  EXPECT_GT(tally.undefined, 1'000'000);
  EXPECT_GT(tally.defined, 2000);
}

// The third word where it too belongs to the opcode, and the one behind an absolute address.
TEST(Decode, EveryThirdWordBehindTwo) {
  Tally tally;
  for (u32 word = 0; word < 0x10000; ++word) {
    const auto w = static_cast<u16>(word);
    for (const u16 second : {0x7830, 0x78b0, 0x7831, 0x78f8}) {
      compare(std::array<u16, 5>{0x0100, second, w, 0, 0}, tally);
      compare(std::array<u16, 5>{0x0140, second, w, 0, 0}, tally);
    }
    for (const u16 first : {0x6a10, 0x6a18, 0x6a11})
      compare(std::array<u16, 5>{first, 0xe100, w, 0, 0}, tally);
    for (const u16 first : {0x6a30, 0x6a38, 0x6a39})
      compare(std::array<u16, 5>{first, 0x00ff, 0xe100, w, 0}, tally);
  }
  EXPECT_GT(tally.undefined, 500'000);
  // Displacements 2 x (16 + 2), bits 4 x 88.
  EXPECT_EQ(tally.defined, 388);
}

// Five units at random, cut short at random: an instruction that is not all there is none.
TEST(Decode, InstructionsCutShort) {
  std::mt19937 random(1);
  Tally tally;
  for (int k = 0; k < 200'000; ++k) {
    std::array<u16, 5> units{};
    for (u16& unit : units) unit = static_cast<u16>(random());
    if (random() % 2) units[0] = static_cast<u16>(0x0100 | (units[0] & 0xf1));
    if (random() % 4 == 0) units[1] = static_cast<u16>(0x7800 | (units[1] & 0xf0));
    const Form* whole = find(units);
    compare(units, tally);
    if (!whole) continue;
    const auto length = static_cast<std::size_t>(whole->units());
    for (std::size_t n = 1; n < length; ++n)
      EXPECT_EQ(decode(std::span(units).first(n), false).opcode, nullptr) << whole->name;
  }
  EXPECT_GT(tally.defined, 10'000);
}

// A word that is not an instruction stops the chip there, whatever precedes it.
TEST(Decode, UndefinedWordsStopTheChip) {
  std::mt19937 random(2);
  int tried = 0;
  Chip chip = testing::make_chip(std::vector<u16>{});
  for (int k = 0; k < 20'000; ++k) {
    std::array<u16, 5> units{};
    for (u16& unit : units) unit = static_cast<u16>(random());
    if (random() % 2) units[0] = static_cast<u16>(0x0100 | (units[0] & 0xff));
    if (find(units)) continue;
    ++tried;
    for (u32 n = 0; n < 10; ++n)
      chip.poke(testing::kCode + n, static_cast<u8>(units[n / 2] >> (n % 2 ? 0 : 8)));
    chip.reset();
    const Registers before = chip.registers();
    ASSERT_EQ(before.pc, testing::kCode);
    const Stop stop = chip.step();
    ASSERT_EQ(stop.reason, Stop::Reason::undefined_instruction) << std::hex << units[0];
    ASSERT_EQ(chip.registers(), before) << std::hex << units[0];
    if (tried == 400) break;
  }
  EXPECT_EQ(tried, 400);
}

}  // namespace
}  // namespace kaz::h8s::oracle
