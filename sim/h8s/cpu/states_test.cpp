// State counts: every row of the manual's table, with encodings from the instruction list.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

struct Row {
  const char* name;
  std::vector<std::uint16_t> words;
  int states;
};

// ER0 = 3, ER1 points at RAM, ER2 = 5, ER3 at a register of the 8-bit bus (P1DR), ER4 at one of the
// 16-bit bus (TCORA0), ER5 at kCode + 0x40, ER6 at RAM.
Chip prepared(const std::vector<std::uint16_t>& words) {
  Chip chip = make_chip(words);
  Registers r = chip.registers();
  r.er = {3, kRamData, 5, 0xffffb2, 0xffffcc, kCode + 0x40, kRamData + 0x100, kStack - 0x40};
  r.ccr = 0x80;
  chip.set_registers(r);
  return chip;
}

class StateCount : public ::testing::TestWithParam<Row> {};

TEST_P(StateCount, MatchesManual) {
  const Row& row = GetParam();
  Chip chip = prepared(row.words);
  const States before = chip.now();
  const Stop stop = chip.step();
  ASSERT_EQ(stop.reason, Stop::Reason::reached) << stop.report;
  EXPECT_EQ(chip.now() - before, row.states) << row.name << ": " << chip.disassemble(kCode);
}

const Row kRows[] = {
    {"add_b_imm", {0x8801}, 1},
    {"add_b", {0x0808}, 1},
    {"add_w", {0x0900}, 1},
    {"add_l", {0x0a80}, 1},
    {"add_w_imm", {0x7910, 1}, 2},
    {"add_l_imm", {0x7a10, 0, 1}, 3},
    {"sub_b", {0x1808}, 1},
    {"sub_w_imm", {0x7930, 1}, 2},
    {"sub_l_imm", {0x7a30, 0, 1}, 3},
    {"cmp_b_imm", {0xa801}, 1},
    {"cmp_w_imm", {0x7920, 1}, 2},
    {"cmp_l_imm", {0x7a20, 0, 1}, 3},
    {"addx", {0x0e08}, 1},
    {"subx_imm", {0xb801}, 1},
    {"and_b_imm", {0xe801}, 1},
    {"and_w", {0x6600}, 1},
    {"and_w_imm", {0x7960, 1}, 2},
    {"and_l_imm", {0x7a60, 0, 1}, 3},
    {"and_l", {0x01f0, 0x6620}, 2},
    {"or_l", {0x01f0, 0x6420}, 2},
    {"xor_l", {0x01f0, 0x6520}, 2},
    {"mov_l", {0x0fa0}, 1},
    {"mov_l_imm", {0x7a00, 0, 1}, 3},
    {"inc_b", {0x0a08}, 1},
    {"dec_l", {0x1b70}, 1},
    {"adds", {0x0b90}, 1},
    {"neg_l", {0x17b0}, 1},
    {"not_w", {0x1710}, 1},
    {"exts_l", {0x17f0}, 1},
    {"shll_l2", {0x1070}, 1},
    {"rotxr_b", {0x1308}, 1},
    {"daa", {0x0f08}, 1},
    {"das", {0x1f08}, 1},
    {"bset_reg", {0x7008}, 1},
    {"btst_rn", {0x6308}, 1},
    {"ldc_reg", {0x0308}, 1},
    {"stc_reg", {0x0208}, 1},
    {"orc", {0x0480}, 1},
    {"ldc_exr", {0x0141, 0x0700}, 2},
    {"nop", {0x0000}, 1},
    {"btst_ind", {0x7c10, 0x7300}, 3},
    {"btst_aa8_io", {0x7eb2, 0x7300}, 4},
    {"btst_aa8_ram", {0x7e10, 0x7300}, 3},
    {"bld_aa16", {0x6a10, 0xe100, 0x7700}, 4},
    {"band_aa32", {0x6a30, 0x00ff, 0xe100, 0x7600}, 5},
    {"bset_ind", {0x7d10, 0x7000}, 4},
    {"bset_aa8_ram", {0x7f10, 0x7000}, 4},
    {"bset_aa8_io", {0x7fb2, 0x7000}, 6},
    {"bclr_aa16", {0x6a18, 0xe100, 0x7200}, 5},
    {"bist_aa32", {0x6a38, 0x00ff, 0xe100, 0x67b0}, 6},
    {"bra8", {0x4002}, 2},
    {"brn8", {0x4102}, 2},
    {"bne16", {0x5860, 0x0010}, 3},
    {"beq16", {0x5870, 0x0010}, 3},
    {"bsr8", {0x5510}, 4},
    {"bsr16", {0x5c00, 0x0010}, 5},
    {"jmp_reg", {0x5950}, 2},
    {"jmp_aa24", {0x5a00, 0x1040}, 3},
    {"jmp_ind", {0x5b20}, 5},
    {"jsr_reg", {0x5d50}, 4},
    {"jsr_aa24", {0x5e00, 0x1040}, 5},
    {"jsr_ind", {0x5f20}, 6},
    {"rts", {0x5470}, 5},
    {"rte", {0x5670}, 5},
    {"trapa", {0x5700}, 8},
    {"mov_b_ind", {0x6818}, 2},
    {"mov_b_store", {0x6898}, 2},
    {"mov_b_d16", {0x6e18, 4}, 3},
    {"mov_b_d32", {0x7810, 0x6a28, 0, 4}, 5},
    {"mov_b_inc", {0x6c18}, 3},
    {"mov_b_dec", {0x6c98}, 3},
    {"mov_b_aa8_ram", {0x2810}, 2},
    {"mov_b_aa8_io", {0x28b2}, 3},
    {"mov_b_aa16", {0x6a08, 0xe100}, 3},
    {"mov_b_aa32", {0x6a28, 0x00ff, 0xe100}, 4},
    {"mov_b_store_aa8", {0x3810}, 2},
    {"mov_w_ind", {0x6910}, 2},
    {"mov_w_ind_io8", {0x6930}, 5},
    {"mov_w_store_io8", {0x69b0}, 5},
    {"mov_w_d16", {0x6f10, 4}, 3},
    {"mov_w_d32", {0x7810, 0x6b20, 0, 4}, 5},
    {"mov_w_inc", {0x6d10}, 3},
    {"push_w", {0x6df0}, 3},
    {"pop_w", {0x6d70}, 3},
    {"mov_w_aa16", {0x6b00, 0xe100}, 3},
    {"mov_w_aa32", {0x6b20, 0x00ff, 0xe100}, 4},
    {"mov_l_ind", {0x0100, 0x6910}, 4},
    {"mov_l_d16", {0x0100, 0x6f10, 4}, 5},
    {"mov_l_d32", {0x0100, 0x7810, 0x6b20, 0, 4}, 7},
    {"mov_l_inc", {0x0100, 0x6d10}, 5},
    {"push_l", {0x0100, 0x6df0}, 5},
    {"pop_l", {0x0100, 0x6d70}, 5},
    {"mov_l_aa16", {0x0100, 0x6b00, 0xe100}, 5},
    {"mov_l_aa32", {0x0100, 0x6b20, 0x00ff, 0xe100}, 6},
    {"mov_l_store", {0x0100, 0x6990}, 4},
    {"mulxu_b", {0x50a0}, 12},
    {"mulxu_w", {0x5220}, 20},
    {"divxu_b", {0x51a0}, 12},
    {"divxu_w", {0x5320}, 20},
    {"mulxs_b", {0x01c0, 0x50a0}, 13},
    {"mulxs_w", {0x01c0, 0x5220}, 21},
    {"divxs_b", {0x01d0, 0x51a0}, 13},
    {"divxs_w", {0x01d0, 0x5320}, 21},
    {"ldc_ind", {0x0140, 0x6910}, 3},
    {"stc_d16", {0x0140, 0x6f90, 4}, 4},
    {"ldc_d32", {0x0140, 0x7810, 0x6b20, 0, 4}, 6},
    {"ldc_inc", {0x0140, 0x6d10}, 4},
    {"stc_dec", {0x0140, 0x6d90}, 4},
    {"stc_aa16", {0x0140, 0x6b80, 0xe100}, 4},
    {"ldc_aa32", {0x0140, 0x6b20, 0x00ff, 0xe100}, 5},
    {"stm2", {0x0110, 0x6df0}, 7},
    {"stm3", {0x0120, 0x6df4}, 9},
    {"stm4", {0x0130, 0x6df0}, 11},
    {"ldm2", {0x0110, 0x6d71}, 7},
    {"ldm3", {0x0120, 0x6d76}, 9},
    {"ldm4", {0x0130, 0x6d73}, 11},
    {"tas", {0x01e0, 0x7b1c}, 4},
    {"sleep", {0x0180}, 2},
};

INSTANTIATE_TEST_SUITE_P(Manual, StateCount, ::testing::ValuesIn(kRows),
                         [](const auto& row) { return std::string(row.param.name); });

// 4 + 2n, the counts in R4L and R4; nothing to do costs 4.
TEST(BlockMove, TakesTwoStatesAByte) {
  for (const std::uint16_t second : {0x7b5c, 0x7bd4}) {
    for (const int n : {0, 1, 10, 255}) {
      Chip chip = make_chip({second, 0x598f});
      Registers r = chip.registers();
      r.er[4] = static_cast<std::uint32_t>(n);
      r.er[5] = kRamData;
      r.er[6] = kRamData + 0x200;
      chip.set_registers(r);
      for (int k = 0; k < n; ++k)
        chip.poke(kRamData + static_cast<std::uint32_t>(k), static_cast<std::uint8_t>(k));
      ASSERT_TRUE(run_to(chip, kCode + 4));
      EXPECT_EQ(chip.now(), 4 + 2 * n);
      EXPECT_EQ(chip.registers().er[4], 0u);
      EXPECT_EQ(chip.registers().er[5], kRamData + static_cast<std::uint32_t>(n));
      for (int k = 0; k < n; ++k)
        ASSERT_EQ(chip.peek(kRamData + 0x200 + static_cast<std::uint32_t>(k)),
                  static_cast<std::uint8_t>(k));
    }
  }
}

// Words and long words on the 16-bit bus of the timers cost one state a word more than RAM.
TEST(IoWidth, WordOnTimerBusTakesTwoStates) {
  for (const bool wide : {true, false}) {
    Options options;
    options.wide_timer_bus = wide;
    Program p;
    p.modules_on();
    const std::uint32_t at = end_of(p);
    p.words({0x6b00, 0xffcc});
    Chip chip = make_chip(p, options);
    ASSERT_TRUE(run_to(chip, at));
    const States before = chip.now();
    chip.step();
    EXPECT_EQ(chip.now() - before, wide ? 2 + 2 : 2 + 4);
    EXPECT_EQ(chip.registers().er[0] & 0xffff, 0xffffu);
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
