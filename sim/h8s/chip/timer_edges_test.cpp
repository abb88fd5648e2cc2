// Predicted edges at the timers' pins, against the pin's level in every state.
// SPDX-License-Identifier: Apache-2.0
#include <random>
#include <utility>

#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

using Edges = std::vector<std::pair<States, bool>>;

constexpr std::uint32_t kTcr0 = 0xffffc8, kTcsr0 = 0xffffca, kTcora = 0xffffcc, kTcorb = 0xffffce;
constexpr std::uint32_t kTcnt = 0xffffd0, kStcr = 0xffffc3;

// Runs `p` and then `states` NOPs, once with the pin watched and once reading it state by state.
// Gives the number of edges.
std::size_t compare(Program p, const char* pin_name, int states, const std::string& what) {
  const std::uint32_t begun = end_of(p);
  p.nops(states + 20).stay();
  const Pin pin = *find_pin(pin_name);
  Edges reported, sampled;
  {
    Chip chip = make_chip(p);
    EXPECT_TRUE(run_to(chip, begun));
    const States start = chip.now();
    chip.watch(pin, [&](const PinEdge& e) { reported.emplace_back(e.at, e.level); });
    chip.run_until(start + states);
  }
  {
    Chip chip = make_chip(p);
    EXPECT_TRUE(run_to(chip, begun));
    const States start = chip.now();
    bool level = chip.level(pin);
    while (chip.now() < start + states) {
      chip.step();
      if (chip.level(pin) == level) continue;
      level = !level;
      sampled.emplace_back(chip.now(), level);
    }
  }
  EXPECT_EQ(reported, sampled) << pin_name << ": " << what;
  return reported.size();
}

// Small periods, so that clears, both matches and overflows of the cascade all come.
class TmrDice {
 public:
  std::uint8_t below(unsigned n) { return static_cast<std::uint8_t>(random_() % n); }

 private:
  std::mt19937 random_{20260101};
};

TEST(TimerEdges, OfTmoInEveryMode) {
  TmrDice dice;
  std::size_t edges = 0;
  for (int round = 0; round < 120; ++round) {
    const auto clear = [&] { return static_cast<std::uint8_t>(dice.below(3) << 3); };
    const bool pair = round % 3 == 1, counts_matches = round % 3 == 2;
    Program p;
    p.modules_on().out8(kStcr, 0x03);
    for (unsigned n = 0; n < 2; ++n) {
      p.out8(kTcora + n, dice.below(n == 0 && pair ? 3 : 12));
      p.out8(kTcorb + n, dice.below(n == 0 && pair ? 3 : 12));
      p.out8(kTcsr0 + n, dice.below(16));
      p.out8(kTcnt + n, n == 0 ? 0 : dice.below(40));
    }
    p.out8(kTcr0 + 1, static_cast<std::uint8_t>(clear() | (counts_matches ? 4 : 1)));
    p.out8(kTcr0, static_cast<std::uint8_t>(clear() | (pair ? 4 : 1)));
    const std::string what = "round " + std::to_string(round);
    edges += compare(p, "TMO0", 2600, what) + compare(p, "TMO1", 2600, what);
  }
  EXPECT_GT(edges, 1000u);
}

TEST(TimerEdges, OfTmox) {
  TmrDice dice;
  std::size_t edges = 0;
  for (int round = 0; round < 60; ++round) {
    Program p;
    p.modules_on().out8(0xfffff6, dice.below(12)).out8(0xfffff7, dice.below(12));
    p.out8(0xfffff1, dice.below(16));
    p.out8(0xfffff0, static_cast<std::uint8_t>(dice.below(3) << 3 | (1 + dice.below(3))));
    edges += compare(p, "TMOX", 1200, "round " + std::to_string(round));
  }
  EXPECT_GT(edges, 500u);
}

TEST(TimerEdges, OfFtoaAndFtobWithTheirNextLevelWrittenMeanwhile) {
  TmrDice dice;
  std::size_t edges = 0;
  for (int round = 0; round < 60; ++round) {
    Program p;
    p.modules_on().out16(0xffff94, dice.below(30)).out8(0xffff97, 0x10);
    p.out16(0xffff94, dice.below(30)).out8(0xffff91, dice.below(2));
    p.out8(0xffff97, static_cast<std::uint8_t>(0x0c | dice.below(4))).out16(0xffff92, 0);
    const std::string what = "round " + std::to_string(round);
    edges += compare(p, "FTOA", 400, what) + compare(p, "FTOB", 400, what);
  }
  EXPECT_GT(edges, 20u);
}

TEST(TimerEdges, OfPwmAndPwmx) {
  constexpr const char* names[] = {"PW2", "PW3"};
  TmrDice dice;
  std::size_t edges = 0;
  for (int round = 0; round < 24; ++round) {
    const std::uint8_t cks = round % 2 ? 0xe0 : 0xa0;
    const unsigned data = dice.below(255), channel = 2 + dice.below(2);
    const std::uint8_t sense = dice.below(2) ? 0xff : 0x00;
    Program p;
    p.modules_on()
        .out8(0xffffb0, 0xff)
        .out8(0xffff82, static_cast<std::uint8_t>(dice.below(4) << 1));
    p.out8(0xffffd6, static_cast<std::uint8_t>(0x20 | channel));
    p.out8(0xffffd7, static_cast<std::uint8_t>(data)).out8(0xffffd5, sense).out8(0xffffd3, 0xff);
    p.out8(0xffffd6, static_cast<std::uint8_t>(cks | channel));
    edges += compare(p, names[channel - 2], 5000, "PWDR " + std::to_string(data));
  }
  EXPECT_GT(edges, 500u);
  for (const std::uint8_t dacr : {0x7c, 0x7d, 0x7e, 0x7f}) {  // PWME, OEB, OEA; OS, CKS
    for (const bool long_cycle : {false, true}) {
      const unsigned dadr = 0x1d43u << 2 | (long_cycle ? 2 : 0);
      Program p;
      p.modules_on().out8(kStcr, 0x10);
      p.out8(0xffffa0, static_cast<std::uint8_t>(dadr >> 8));
      p.out8(0xffffa1, static_cast<std::uint8_t>(dadr | 1));
      p.out8(0xffffa6, static_cast<std::uint8_t>((dadr ^ 0x5540) >> 8));
      p.out8(0xffffa7, static_cast<std::uint8_t>((dadr ^ 0x5540) | 1)).out8(0xffffa0, dacr);
      edges = compare(p, "PWX0", 5000, "PWX") + compare(p, "PWX1", 5000, "PWX");
      EXPECT_GT(edges, 30u);
    }
  }
}

// The duty cycle reported to the board is that of the edges, also for cascaded timers.
TEST(TimerEdges, MeanOfCascadesIsTheShareHigh) {
  struct Case {
    std::uint8_t tcr0, tcr1, tcsr0, tcsr1;
    States turn;  // states of a whole turn
    double share0, share1;
  };
  // TCORA = 0102, TCORB = 0005.
  const Case cases[] = {
      // 16 bits, clear at A after 0x103 counts; TMO0 low at A, high at B (after 6 counts). TMO1 by
      // the low byte: low at A (3), high at B (6), and low as the second lap ends with the clear.
      {0x0c, 0x01, 0x09, 0x09, 2 * 0x103, 253.0 / 259, 253.0 / 259},
      {0x04, 0x01, 0x09, 0x09, 2 * 0x10000, 253.0 / 65536, 253.0 / 256},
      // TMR1 counts TMR0's matches (a turn of 2 counts each), clears at B (6): high from 3 to 6.
      {0x09, 0x14, 0x03, 0x06, 2 * 2 * 6, 0.5, 0.5},
  };
  for (const Case& c : cases) {
    Program p;
    p.modules_on().out8(kStcr, 0x03).out16(kTcora, 0x0102).out16(kTcorb, 0x0005);
    p.out8(kTcsr0, c.tcsr0).out8(kTcsr0 + 1, c.tcsr1).out8(kTcr0 + 1, c.tcr1).out8(kTcr0, c.tcr0);
    const std::uint32_t begun = end_of(p);
    Chip chip = make_chip(p.stay());
    ASSERT_TRUE(run_to(chip, begun));
    EXPECT_NEAR(chip.tmo_high_share(0), c.share0, 1e-9);
    EXPECT_NEAR(chip.tmo_high_share(1), c.share1, 1e-9);
    // The edges of two turns, once settled.
    chip.run_until(4 * c.turn);
    const States from = chip.now();
    for (const unsigned n : {0u, 1u}) {
      const Pin pin = *find_pin(n == 0 ? "TMO0" : "TMO1");
      Chip again = chip.clone();
      States since = from, high = 0;
      again.watch(pin, [&](const PinEdge& e) {
        if (!e.level) high += e.at - since;
        since = e.at;
      });
      again.run_until(from + 2 * c.turn);
      if (again.level(pin)) high += from + 2 * c.turn - since;
      EXPECT_EQ(again.level(pin), chip.level(pin));
      EXPECT_NEAR(static_cast<double>(high) / static_cast<double>(2 * c.turn),
                  n == 0 ? c.share0 : c.share1, 1e-9);
    }
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
