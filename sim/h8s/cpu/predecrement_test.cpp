// MOV between memory and the very register that points there: both settings of the option, each engine.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/flat/flat.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint8_t kN = 8, kZ = 4;

struct Store {
  const char* text;
  std::vector<std::uint16_t> words;
  int pointer;
  std::uint32_t before, after;  // of the address register
  unsigned bytes;
  // The value stored, and N and Z: the register after the decrement, and before it.
  std::uint32_t decremented;
  std::uint8_t flags;
  std::uint32_t old;
  std::uint8_t old_flags;
};

// clang-format off
const Store kStores[] = {
    {"mov.b r0l,@-er0", {0x6c88}, 0, 0x00ffe401, 0x00ffe400, 1, 0x00, kZ, 0x01, 0},
    {"mov.b r0l,@-er0, borrow", {0x6c88}, 0, 0x00ffe400, 0x00ffe3ff, 1, 0xff, kN, 0x00, kZ},
    {"mov.b r0h,@-er0, borrow", {0x6c80}, 0, 0x00ffe400, 0x00ffe3ff, 1, 0xe3, kN, 0xe4, kN},
    {"mov.b r5l,@-er5", {0x6cdd}, 5, 0x12ffe480, 0x12ffe47f, 1, 0x7f, 0, 0x80, kN},
    {"mov.w r0,@-er0", {0x6d80}, 0, 0x00ffe400, 0x00ffe3fe, 2, 0xe3fe, kN, 0xe400, kN},
    {"mov.w e0,@-er0", {0x6d88}, 0, 0x80ffe400, 0x80ffe3fe, 2, 0x80ff, kN, 0x80ff, kN},
    {"mov.w r6,@-er6", {0x6de6}, 6, 0x00ffe102, 0x00ffe100, 2, 0xe100, kN, 0xe102, kN},
    {"mov.l er0,@-er0", {0x0100, 0x6d80}, 0, 0x00ffe402, 0x00ffe3fe, 4, 0x00ffe3fe, 0, 0x00ffe402, 0},
    {"mov.l er4,@-er4", {0x0100, 0x6dc4}, 4, 0xffffe404, 0xffffe400, 4, 0xffffe400, kN, 0xffffe404, kN},
    {"push.w r7", {0x6df7}, 7, 0x00ffee00, 0x00ffedfe, 2, 0xedfe, kN, 0xee00, kN},
    {"push.w e7", {0x6dff}, 7, 0x00ffee00, 0x00ffedfe, 2, 0x00ff, 0, 0x00ff, 0},
    {"push.l er7", {0x0100, 0x6df7}, 7, 0x00ffee00, 0x00ffedfc, 4, 0x00ffedfc, 0, 0x00ffee00, 0},
    {"mov.b r7l,@-er7", {0x6cff}, 7, 0x00ffee01, 0x00ffee00, 1, 0x00, kZ, 0x01, 0},
};
// clang-format on

class Predecrement : public ::testing::TestWithParam<Engine> {
 protected:
  // nop ; the instruction ; nop ; bra . from these registers; run by the engine that is meant.
  static Chip run(const std::vector<std::uint16_t>& words, bool decremented, Registers r) {
    Options options;
    options.engine = GetParam();
    options.translate_after = 1;
    options.predecrement_stores_decremented = decremented;
    std::vector<std::uint16_t> program{0x0000};
    program.insert(program.end(), words.begin(), words.end());
    program.insert(program.end(), {0x0000, 0x40fe});
    Chip chip = make_chip(program, options);
    chip.step();  // the first instruction after a reset runs alone
    r.pc = kCode;
    chip.set_registers(r);
    const std::int64_t before = chip.instructions();
    const Stop stop = chip.run_until(chip.now() + 40);
    EXPECT_EQ(stop.reason, Stop::Reason::reached) << stop.report;
    if (GetParam() == Engine::translator && translator_available()) {
      EXPECT_EQ(chip.translated_instructions(), chip.instructions() - before);
    }
    return chip;
  }
  static std::uint32_t read(const Chip& chip, std::uint32_t address, unsigned bytes) {
    std::uint32_t value = 0;
    for (unsigned k = 0; k < bytes; ++k)
      value = value << 8 | chip.peek((address & 0xffffff) + k).value_or(0);
    return value;
  }
};

INSTANTIATE_TEST_SUITE_P(Engines, Predecrement,
                         ::testing::Values(Engine::reference, Engine::interpreter,
                                           Engine::translator),
                         [](const auto& engine) { return name_of(engine.param); });

TEST_P(Predecrement, StoresTheRegisterAsTheOptionSays) {
  for (const Store& row : kStores) {
    for (const bool decremented : {true, false}) {
      Registers r;
      r.er = {1, 2, 3, 4, 5, 6, 7, 0xffee00};
      r.er[static_cast<std::size_t>(row.pointer)] = row.before;
      r.ccr = 0x80 | (row.flags == 0 ? kN | kZ : 0) | 2;
      const Chip chip = run(row.words, decremented, r);
      const Registers now = chip.registers();
      r.er[static_cast<std::size_t>(row.pointer)] = row.after;
      EXPECT_EQ(now.er, r.er) << row.text;
      EXPECT_EQ(read(chip, row.after, row.bytes), decremented ? row.decremented : row.old)
          << row.text << decremented;
      EXPECT_EQ(now.ccr, 0x80 | (decremented ? row.flags : row.old_flags))
          << row.text << decremented;
    }
  }
}

// A branch reads the flags of the value stored.
TEST_P(Predecrement, BranchesOnWhatWasStored) {
  for (const bool decremented : {true, false}) {
    Registers r;
    r.er[0] = 0xffe401;
    r.er[7] = 0xffee00;
    r.ccr = 0x80;
    // mov.b r0l,@-er0 ; beq +2 ; adds #1,er1 ; mov.l er0,er2
    const Chip chip = run({0x6c88, 0x4702, 0x0b01, 0x0f82}, decremented, r);
    EXPECT_EQ(chip.registers().er[1], decremented ? 0u : 1u);
    EXPECT_EQ(chip.registers().er[2], 0xffe400u);
  }
}

TEST_P(Predecrement, AnotherRegisterIsStoredAsItIs) {
  for (const bool decremented : {true, false}) {
    Registers r;
    r.er = {0xffe404, 0x12345678, 0, 0, 0, 0, 0, 0xffee00};
    const Chip chip = run({0x0100, 0x6d81}, decremented, r);  // mov.l er1,@-er0
    EXPECT_EQ(read(chip, 0xffe400, 4), 0x12345678u);
    EXPECT_EQ(chip.registers().er[0], 0xffe400u);
  }
}

// H8S/2138 manual, figure 4.6: a byte access changes SP by one.
TEST_P(Predecrement, ABytePushedLeavesTheStackPointerOdd) {
  Registers r;
  r.er[1] = 0x5a;
  r.er[7] = 0xffee00;
  // mov.b r1l,@-er7 ; mov.b @er7+,r2l ; mov.b r1l,@-er7
  const Chip chip = run({0x6cf9, 0x6c7a, 0x6cf9}, true, r);
  EXPECT_EQ(chip.registers().er[7], 0xffedffu);
  EXPECT_EQ(chip.registers().er[2], 0x5au);
  EXPECT_EQ(chip.peek(0xffedff), 0x5a);
}

// MOV @ERs+,Rd with Rd in ERs: the loaded value is written last.
TEST_P(Predecrement, OfAPostincrementTheLoadedValueStays) {
  const struct {
    std::vector<std::uint16_t> load;
    std::uint32_t after;
  } rows[] = {
      {{0x0100, 0x6d00}, 0xcafe8001},  // mov.l @er0+,er0
      {{0x6d00}, 0x00ffcafe},          // mov.w @er0+,r0
      {{0x6d08}, 0xcafee402},          // mov.w @er0+,e0
      {{0x6c08}, 0x00ffe4ca},          // mov.b @er0+,r0l
      {{0x6c00}, 0x00ffca01},          // mov.b @er0+,r0h
  };
  for (const auto& row : rows) {
    Registers r;
    r.er = {0xffe400, 0xcafe8001, 0, 0, 0, 0, 0, 0xffee00};
    // mov.l er1,@er0 ; the load
    std::vector<std::uint16_t> words{0x0100, 0x6981};
    words.insert(words.end(), row.load.begin(), row.load.end());
    for (const bool decremented : {true, false})
      EXPECT_EQ(run(words, decremented, r).registers().er[0], row.after);
  }
}

// The upper half too is taken after the borrow: only the flat machine has memory there.
TEST_P(Predecrement, OnTheFlatMachine) {
  for (const bool decremented : {true, false}) {
    FlatOptions options;
    options.engine = GetParam();
    options.translate_after = 1;
    options.semihost = false;
    options.predecrement_stores_decremented = decremented;
    Flat flat(options);
    // mov.l #0x20000,er0 ; mov.w e0,@-er0 ; nop ; bra .
    const std::uint8_t code[] = {0x7a, 0x00, 0x00, 0x02, 0x00, 0x00, 0x6d, 0x88, 0, 0, 0x40, 0xfe};
    Image image;
    image.segments.push_back({0x1000, 0x1000, "code", {std::begin(code), std::end(code)}});
    image.entry = 0x1000;
    ASSERT_TRUE(flat.load(image).has_value());
    EXPECT_EQ(flat.run(100).reason, FlatStop::Reason::reached);
    EXPECT_EQ(flat.peek(0x1ffff), decremented ? 1 : 2);
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
