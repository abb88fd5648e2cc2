// Effects of instructions on registers, memory and flags; expected values by hand from the flag table.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

// CCR bits.
constexpr std::uint8_t kH = 0x20, kN = 8, kZ = 4, kV = 2, kC = 1;

struct Row {
  const char* name;
  std::vector<std::uint16_t> words;
  std::uint32_t er0,
      er1;  // before; the instructions use R1 or ER1 as source and R0 or ER0 as destination
  std::uint8_t flags;    // H N Z V C before
  std::uint32_t result;  // ER0 after
  std::uint8_t after;
};

class Operation : public ::testing::TestWithParam<Row> {};

TEST_P(Operation, GivesResultAndFlags) {
  const Row& row = GetParam();
  Chip chip = make_chip(row.words);
  Registers r = chip.registers();
  r.er[0] = row.er0;
  r.er[1] = row.er1;
  r.ccr = 0x80 | row.flags;
  chip.set_registers(r);
  const Stop stop = chip.step();
  ASSERT_EQ(stop.reason, Stop::Reason::reached) << stop.report;
  EXPECT_EQ(chip.registers().er[0], row.result) << chip.disassemble(kCode);
  EXPECT_EQ(chip.registers().ccr & 0x2f, row.after) << chip.disassemble(kCode);
  EXPECT_EQ(chip.registers().pc, kCode + 2 * row.words.size());
}

// clang-format off
const Row kRows[] = {
    // add.b r1l,r0l
    {"add_b_plain", {0x0898}, 0x11223301, 2, 0, 0x11223303, 0},
    {"add_b_half", {0x0898}, 0x0f, 1, 0, 0x10, kH},
    {"add_b_overflow", {0x0898}, 0x7f, 1, 0, 0x80, kH | kN | kV},
    {"add_b_carry", {0x0898}, 0xff, 1, 0, 0x00, kH | kZ | kC},
    {"add_b_negative", {0x0898}, 0x80, 0x80, 0, 0x00, kZ | kV | kC},
    {"add_b_high", {0x0810}, 0x12345678, 0x0100, 0, 0x12345778, 0},  // add.b r1h,r0h
    {"add_w_half", {0x0910}, 0xaaaa0fff, 1, 0, 0xaaaa1000, kH},
    {"add_w_overflow", {0x0910}, 0x7fff, 1, 0, 0x8000, kH | kN | kV},
    {"add_w_e", {0x0998}, 0x0001ffff, 0x00020000, 0, 0x0003ffff, 0},  // add.w e1,e0
    {"add_l_half", {0x0a90}, 0x0fffffff, 1, 0, 0x10000000, kH},
    {"add_l_carry", {0x0a90}, 0xffffffff, 1, 0, 0, kH | kZ | kC},
    {"sub_b_borrow", {0x1898}, 0x00, 1, 0, 0xff, kH | kN | kC},
    {"sub_b_overflow", {0x1898}, 0x80, 1, 0, 0x7f, kH | kV},
    {"sub_w_zero", {0x1910}, 0x1234, 0x1234, kC, 0, kZ},
    {"sub_l_borrow", {0x1a90}, 0, 1, 0, 0xffffffff, kH | kN | kC},
    {"cmp_b", {0x1c98}, 5, 6, 0, 5, kH | kN | kC},
    {"cmp_l_equal", {0x1f90}, 7, 7, kC, 7, kZ},
    {"addx_keeps_z", {0x0e98}, 0xff, 0, kC | kZ, 0x00, kH | kZ | kC},
    {"addx_keeps_not_z", {0x0e98}, 0xff, 0, kC, 0x00, kH | kC},
    {"addx_clears_z", {0x0e98}, 1, 1, kZ, 2, 0},
    {"addx_half_by_carry", {0x0e98}, 0x0f, 0, kC, 0x10, kH},
    {"subx_keeps_z", {0x1e98}, 6, 5, kC | kZ, 0, kZ},
    {"subx_clears_z", {0x1e98}, 0, 0, kC | kZ, 0xff, kH | kN | kC},
    {"subx_keeps_not_z", {0x1e98}, 5, 5, 0, 0, 0},
    {"adds", {0x0b90}, 0xffffffff, 0, kN | kC, 3, kN | kC},
    {"subs", {0x1b80}, 1, 0, kZ, 0xffffffff, kZ},
    {"inc_b_overflow", {0x0a08}, 0x7f, 0, kC | kH, 0x80, kH | kN | kV | kC},
    {"inc_b_wrap", {0x0a08}, 0xff, 0, 0, 0, kZ},
    {"inc_w_2", {0x0bd0}, 0x7ffe, 0, 0, 0x8000, kN | kV},
    {"inc_l_1", {0x0b70}, 0x7fffffff, 0, 0, 0x80000000, kN | kV},
    {"dec_b_overflow", {0x1a08}, 0x80, 0, 0, 0x7f, kV},
    {"dec_w_2", {0x1bd0}, 1, 0, kC, 0xffff, kN | kC},
    {"neg_b", {0x1788}, 1, 0, 0, 0xff, kH | kN | kC},
    {"neg_b_zero", {0x1788}, 0, 0, kC | kH, 0, kZ},
    {"neg_b_80", {0x1788}, 0x80, 0, 0, 0x80, kN | kV | kC},
    {"neg_l", {0x17b0}, 0x80000000, 0, 0, 0x80000000, kN | kV | kC},
    {"not_w", {0x1710}, 0x1234ffff, 0, kV, 0x12340000, kZ},
    {"extu_w", {0x1750}, 0xabcdef80, 0, kN, 0xabcd0080, 0},
    {"extu_l", {0x1770}, 0xabcd8000, 0, 0, 0x00008000, 0},
    {"exts_w", {0x17d0}, 0xabcd0080, 0, 0, 0xabcdff80, kN},
    {"exts_l", {0x17f0}, 0x00008000, 0, 0, 0xffff8000, kN},
    {"and_b", {0x1698}, 0xf0, 0x0f, kV | kC, 0, kZ | kC},
    {"or_l", {0x01f0, 0x6410}, 0x80000000, 1, kV, 0x80000001, kN},
    {"xor_w", {0x6510}, 0xffff, 0xffff, 0, 0, kZ},
    {"mov_l", {0x0f90}, 0, 0x80000000, kV | kC, 0x80000000, kN | kC},
    {"mov_b_imm", {0xf800}, 0xff, 0, kN, 0, kZ},
    // Shifts: one bit, then two.
    {"shll_b", {0x1008}, 0x81, 0, kV, 0x02, kC},
    {"shal_b_overflow", {0x1088}, 0x40, 0, 0, 0x80, kN | kV},
    {"shal_b_2", {0x10c8}, 0x20, 0, 0, 0x80, kN | kV},
    {"shal_b_2_both", {0x10c8}, 0x60, 0, 0, 0x80, kN | kV | kC},
    {"shlr_l", {0x1130}, 0x80000001, 0, kN, 0x40000000, kC},
    {"shlr_w_2", {0x1150}, 0x8002, 0, 0, 0x2000, kC},
    {"shar_b", {0x1188}, 0x81, 0, 0, 0xc0, kN | kC},
    {"shar_l_2", {0x11f0}, 0x80000000, 0, kC, 0xe0000000, kN},
    {"rotxl_b", {0x1208}, 0x80, 0, kC, 0x01, kC},
    {"rotxl_b_2", {0x1248}, 0x40, 0, kC, 0x02, kC},
    {"rotl_w", {0x1290}, 0x8001, 0, 0, 0x0003, kC},
    {"rotl_w_2", {0x12d0}, 0xc000, 0, 0, 0x0003, kC},
    {"rotxr_l", {0x1330}, 0x00000001, 0, kC, 0x80000000, kN | kC},
    {"rotr_b", {0x1388}, 0x01, 0, 0, 0x80, kN | kC},
    {"rotr_b_2", {0x13c8}, 0x03, 0, 0, 0xc0, kN | kC},
    // Multiplication uses the low half of the destination only.
    {"mulxu_b", {0x5090}, 0xabcdff12, 0x34, kN | kZ, 0xabcd03a8, kN | kZ},
    {"mulxu_w", {0x5210}, 0x1234ffff, 0xffff, kC, 0xfffe0001, kC},
    {"mulxs_b", {0x01c0, 0x5090}, 0x000000ff, 0x02, 0, 0x0000fffe, kN},
    {"mulxs_w", {0x01c0, 0x5210}, 0x00008000, 0x8000, kN, 0x40000000, 0},
    {"mulxs_w_zero", {0x01c0, 0x5210}, 0xffff0000, 5, kC, 0, kZ | kC},
    {"divxu_b", {0x5190}, 0x00000064, 7, kN, 0x0000020e, 0},
    {"divxu_b_sign", {0x5190}, 0x00000100, 0x80, 0, 0x00000002, kN},
    {"divxu_w", {0x5310}, 100000, 300, kZ, (100000 % 300) << 16 | 100000 / 300, 0},
    // -100 / 7 = -14, remainder -2; -100 / -7 = 14, remainder -2.
    {"divxs_b", {0x01d0, 0x5190}, 0x0000ff9c, 7, 0, 0x0000fef2, kN},
    {"divxs_w", {0x01d0, 0x5310}, 0xffffff9c, 0xfff9, kN, 0xfffe000e, 0},
    // Decimal: 19 + 28 = 47, 99 + 01 = 100.
    {"daa_half", {0x0f08}, 0x41, 0, kH, 0x47, kH},
    {"daa_carry", {0x0f08}, 0x9a, 0, 0, 0x00, kZ | kC},
    {"daa_high", {0x0f08}, 0x22, 0, kC, 0x82, kN | kC},
    {"das_half", {0x1f08}, 0x19, 0, kH, 0x13, kH},
    {"das_carry", {0x1f08}, 0xf5, 0, kC, 0x95, kN | kC},
    // Bits of R0L; BLD and friends work on C.
    {"bset", {0x7038}, 0, 0, kZ, 0x08, kZ},
    {"bnot_rn", {0x6198}, 0x80, 0x0f, 0, 0x00, 0},   // bit number is 0x0f & 7 = 7
    {"bclr", {0x7208}, 0xff, 0, 0, 0xfe, 0},
    {"btst_zero", {0x7378}, 0x7f, 0, kN, 0x7f, kN | kZ},
    {"btst_one", {0x7378}, 0x80, 0, kZ, 0x80, 0},
    {"bld", {0x7718}, 2, 0, 0, 2, kC},
    {"bild", {0x7798}, 2, 0, kC, 2, 0},
    {"band", {0x7608}, 0, 0, kC, 0, 0},
    {"biand", {0x7688}, 0, 0, kC, 0, kC},
    {"bor", {0x7408}, 1, 0, 0, 1, kC},
    {"bior", {0x7488}, 1, 0, 0, 1, 0},
    {"bxor", {0x7508}, 1, 0, kC, 1, 0},
    {"bixor", {0x7588}, 1, 0, kC, 1, kC},
    {"bst", {0x6728}, 0, 0, kC, 4, kC},
    {"bist", {0x67a8}, 0, 0, kC, 0, kC},
    {"bist_set", {0x67a8}, 0, 0, 0, 4, 0},
    {"stc", {0x0208}, 0, 0, kH | kN | kV, 0x80 | kH | kN | kV, kH | kN | kV},
    {"ldc", {0x0308}, kN | kZ, 0, kC, kN | kZ, kN | kZ},
};
// clang-format on

INSTANTIATE_TEST_SUITE_P(Facts, Operation, ::testing::ValuesIn(kRows),
                         [](const auto& row) { return std::string(row.param.name); });

// All 16 conditions against all 16 states of N Z V C, by the manual's formulas.
TEST(Branch, ConditionsFollowTheFlags) {
  for (unsigned condition = 0; condition < 16; ++condition) {
    for (unsigned flags = 0; flags < 16; ++flags) {
      const bool n = flags & 8, z = flags & 4, v = flags & 2, c = flags & 1;
      const bool expected[16] = {
          true, false,  !(c || z), c || z,         !c,         c, !z, z, !v, v, !n,
          n,    n == v, n != v,    !(z || n != v), z || n != v};
      for (const bool wide : {false, true}) {
        const auto first =
            static_cast<std::uint16_t>(wide ? 0x5800 | condition << 4 : 0x4010 | condition << 8);
        Chip chip = make_chip({first, 0x0010});
        Registers r = chip.registers();
        r.ccr = static_cast<std::uint8_t>(0x80 | flags);
        chip.set_registers(r);
        chip.step();
        const std::uint32_t next = kCode + (wide ? 4 : 2);
        EXPECT_EQ(chip.registers().pc, expected[condition] ? next + 0x10 : next)
            << condition << " " << flags;
      }
    }
  }
}

// Branches that leave flash wrap into other memory or nowhere.
TEST(Branch, BackwardAcrossZeroStops) {
  Chip chip = make_chip({0x5a00, 0x0200});                              // jmp @0x000200
  chip.poke(0x200, std::vector<std::uint8_t>{0x58, 0x00, 0x80, 0x00});  // bra .-0x8000
  chip.step();
  EXPECT_EQ(chip.step().reason, Stop::Reason::reached);
  const Stop stop = chip.step();
  EXPECT_EQ(stop.reason, Stop::Reason::undefined_instruction);
  EXPECT_NE(stop.report.find("0xff8204"), std::string::npos) << stop.report;
}

TEST(Addressing, EveryModeReachesItsByte) {
  // ER1 = kRamData - 2; destination R0L. The byte at kRamData is 0x5a.
  const std::vector<std::vector<std::uint16_t>> loads = {
      {0x6e18, 0x0002},                  // @(2:16,er1)
      {0x7810, 0x6a28, 0x0000, 0x0002},  // @(2:32,er1)
      {0x6a08, 0xe100},                  // @aa:16, sign-extended
      {0x6a28, 0x00ff, 0xe100},          // @aa:32
      {0x6a28, 0x12ff, 0xe100},          // its upper byte is ignored
      {0x7890, 0x6a28, 0x0000, 0x0002},  // top bit of the register field is ignored
  };
  for (const auto& words : loads) {
    Chip chip = make_chip(words);
    chip.poke(kRamData, 0x5a);
    Registers r = chip.registers();
    r.er[1] = 0xab000000 | (kRamData - 2);
    chip.set_registers(r);
    ASSERT_EQ(chip.step().reason, Stop::Reason::reached);
    EXPECT_EQ(chip.registers().er[0] & 0xff, 0x5au) << chip.disassemble(kCode);
  }
}

TEST(Addressing, IncrementAndDecrement) {
  Chip chip = make_chip(
      {0x0100, 0x6d92, 0x6d12, 0x6c1a});  // mov.l er2,@-er1 ; mov.w @er1+,r2 ; mov.b @er1+,r2l
  Registers r = chip.registers();
  r.er[1] = kRamData;
  r.er[2] = 0x11223344;
  chip.set_registers(r);
  chip.step();
  EXPECT_EQ(chip.registers().er[1], kRamData - 4);
  EXPECT_EQ(chip.peek32(kRamData - 4), 0x11223344u);
  chip.step();
  EXPECT_EQ(chip.registers().er[1], kRamData - 2);
  EXPECT_EQ(chip.registers().er[2], 0x11221122u);
  chip.step();
  EXPECT_EQ(chip.registers().er[1], kRamData - 1);
  EXPECT_EQ(chip.registers().er[2], 0x11221133u);
}

TEST(Stack, StmLdmOrder) {
  Chip chip = make_chip({0x0120, 0x6df0, 0x0120, 0x6d76});  // stm er0-er2 ; ldm er4-er6
  Registers r = chip.registers();
  r.er = {1, 2, 3, 4, 0, 0, 0, kStack};
  chip.set_registers(r);
  chip.step();
  EXPECT_EQ(chip.peek32(kStack - 4), 1u);
  EXPECT_EQ(chip.peek32(kStack - 12), 3u);
  chip.step();
  EXPECT_EQ(chip.registers().er[4], 1u);
  EXPECT_EQ(chip.registers().er[6], 3u);
  EXPECT_EQ(chip.registers().er[7], kStack);
}

TEST(Stack, TrapaAndRteRestoreEverything) {
  Chip chip = make_chip({0x5720});  // trapa #2
  Registers r = chip.registers();
  r.ccr = 0x5d;
  chip.set_registers(r);
  chip.poke(handler(10), std::vector<std::uint8_t>{0x56, 0x70});
  chip.step();
  EXPECT_EQ(chip.registers().pc, handler(10));
  EXPECT_EQ(chip.registers().ccr, 0xdd);
  EXPECT_EQ(chip.peek32(kStack - 4), 0x5d000000u | (kCode + 2));
  chip.step();
  EXPECT_EQ(chip.registers().pc, kCode + 2);
  EXPECT_EQ(chip.registers().ccr, 0x5d);
  EXPECT_EQ(chip.registers().er[7], kStack);
}

TEST(Stack, TasTestsThenSets) {
  Chip chip = make_chip({0x01e0, 0x7b1c});
  Registers r = chip.registers();
  r.er[1] = kRamData;
  chip.set_registers(r);
  chip.poke(kRamData, std::uint8_t{0});
  chip.step();
  EXPECT_EQ(chip.peek(kRamData), 0x80);
  EXPECT_TRUE(chip.registers().ccr & kZ);
}

TEST(Exr, IsReadableAndHasNoEffect) {
  Chip chip = make_chip({0x0141, 0x0780, 0x0218, 0x0211});  // ldc #0x80,exr ; stc exr,r0l
  chip.step();
  chip.step();
  EXPECT_EQ(chip.registers().exr, 0xf8);  // bits 6..3 read as 1
}

TEST(SelfModification, IsSeenByTheNextInstruction) {
  // In RAM: mov.w r0,@er1 rewrites the instruction after it, nop, by inc.b r2l.
  Chip chip = make_chip({0x5a00, 0x1000});
  const std::uint32_t at = kRamData;
  chip.poke(at, std::vector<std::uint8_t>{0x69, 0x90, 0x00, 0x00, 0x40, 0xfa});
  Registers r = chip.registers();
  r.er[0] = 0x0a0a;
  r.er[1] = at + 2;
  r.er[2] = 0;
  r.pc = at + 2;
  chip.set_registers(r);
  for (int k = 0; k < 4; ++k) chip.step();  // nop, bra, mov, inc
  EXPECT_EQ(chip.registers().er[2], 1u);
}

}  // namespace
}  // namespace kaz::h8s::testing
