// Each interrupt of FRT, TMR0, TMR1, TMRX and TMRY: requested in its very state, only where enabled.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

// A request is taken at the first instruction boundary later than 3 states after it, here after the
// fourth NOP of one state; the exception takes 8 states.
constexpr States kToHandler = 4 + 8;
constexpr std::uint32_t kTconri = 0xfffffc, kTconrs = 0xfffffe;

struct Write {
  std::uint32_t address;
  std::uint8_t value;
};

struct Source {
  const char* name;
  unsigned vector;
  States divisor;
  std::int64_t counts;  // from the last of `writes` to the request
  Write enable;
  std::uint8_t others;   // what the enable register holds without this enable
  std::uint32_t status;  // register and bit of the flag
  std::uint8_t flag;
  std::vector<Write> writes;
};

const std::vector<Source> kSources{
    {"ocia",
     52,
     8,
     10,
     {0xffff90, 0x09},
     0x01,
     0xffff91,
     0x08,
     {{0xffff96, 1}, {0xffff94, 0}, {0xffff95, 9}, {0xffff92, 0}, {0xffff93, 0}}},
    {"ocib",
     53,
     32,
     10,
     {0xffff90, 0x05},
     0x01,
     0xffff91,
     0x04,
     {{0xffff96, 2}, {0xffff97, 0x10}, {0xffff94, 0}, {0xffff95, 9}, {0xffff92, 0}, {0xffff93, 0}}},
    {"fovi",
     54,
     2,
     300,
     {0xffff90, 0x03},
     0x01,
     0xffff91,
     0x02,
     {{0xffff96, 0}, {0xffff92, 0xfe}, {0xffff93, 0xd4}}},
    {"cmia0", 64, 8, 10, {0xffffc8, 0x41}, 0x01, 0xffffca, 0x40, {{0xffffcc, 9}, {0xffffc8, 1}}},
    {"cmib0", 65, 64, 3, {0xffffc8, 0x82}, 0x02, 0xffffca, 0x80, {{0xffffce, 2}, {0xffffc8, 2}}},
    {"ovi0", 66, 8, 16, {0xffffc8, 0x21}, 0x01, 0xffffca, 0x20, {{0xffffd0, 0xf0}, {0xffffc8, 1}}},
    {"cmia1", 68, 8, 10, {0xffffc9, 0x41}, 0x01, 0xffffcb, 0x40, {{0xffffcd, 9}, {0xffffc9, 1}}},
    {"cmib1", 69, 64, 3, {0xffffc9, 0x82}, 0x02, 0xffffcb, 0x80, {{0xffffcf, 2}, {0xffffc9, 2}}},
    {"ovi1", 70, 8, 16, {0xffffc9, 0x21}, 0x01, 0xffffcb, 0x20, {{0xffffd1, 0xf0}, {0xffffc9, 1}}},
    {"cmiay",
     72,
     4,
     20,
     {0xfffff0, 0x41},
     0x01,
     0xfffff1,
     0x40,
     {{kTconrs, 0x80}, {0xfffff2, 19}, {0xfffff0, 1}}},
    {"cmiby",
     73,
     256,
     2,
     {0xfffff0, 0x82},
     0x02,
     0xfffff1,
     0x80,
     {{kTconrs, 0x80}, {0xfffff3, 1}, {0xfffff0, 2}}},
    {"oviy",
     74,
     4,
     16,
     {0xfffff0, 0x21},
     0x01,
     0xfffff1,
     0x20,
     {{kTconrs, 0x80}, {0xfffff4, 0xf0}, {0xfffff0, 1}}},
};

// In front of the last write the enable register is written with `enable`, unless the last write is
// that register itself: then with both.
Program program_of(const Source& s, bool enabled, std::uint32_t& begun) {
  Program p;
  p.modules_on();
  const std::uint8_t control = enabled ? s.enable.value : s.others;
  for (std::size_t k = 0; k < s.writes.size(); ++k) {
    const bool last = k + 1 == s.writes.size();
    const bool same = s.writes[k].address == s.enable.address;
    if (last && !same) p.enable_interrupts().out8(s.enable.address, control);
    if (last && same) p.enable_interrupts();
    p.out8(s.writes[k].address, last && same ? control : s.writes[k].value);
  }
  begun = end_of(p);
  p.nops(700);
  return p;
}

class TimerInterrupt : public ::testing::TestWithParam<Source> {};

TEST_P(TimerInterrupt, IsRequestedInItsState) {
  const Source& s = GetParam();
  std::uint32_t begun = 0;
  Program p = program_of(s, true, begun);
  Chip chip = make_chip(p.stay());
  ASSERT_TRUE(run_to(chip, begun));
  const States request = (chip.now() / s.divisor + s.counts) * s.divisor;
  ASSERT_LT(request, chip.now() + 680);
  chip.run_until(request - 1);
  EXPECT_EQ(chip.peek(s.status).value() & s.flag, 0);
  chip.run_until(request);
  ASSERT_EQ(chip.now(), request);
  EXPECT_EQ(chip.peek(s.status).value() & s.flag, s.flag);
  ASSERT_TRUE(run_to(chip, handler(s.vector)));
  EXPECT_EQ(chip.now(), request + kToHandler);
}

TEST_P(TimerInterrupt, WaitsForItsEnable) {
  const Source& s = GetParam();
  std::uint32_t begun = 0;
  Program p = program_of(s, false, begun);
  p.out8(s.enable.address, s.enable.value);
  const std::uint32_t enabled = end_of(p);
  p.nops(50).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, enabled));
  EXPECT_EQ(chip.peek(s.status).value() & s.flag, s.flag);
  const States request = chip.now();
  ASSERT_TRUE(run_to(chip, handler(s.vector)));
  EXPECT_EQ(chip.now(), request + kToHandler);
}

INSTANTIATE_TEST_SUITE_P(All, TimerInterrupt, ::testing::ValuesIn(kSources),
                         [](const auto& param) { return std::string(param.param.name); });

// FTIA..FTID are P62..P65; the edge that IEDG does not choose requests nothing.
TEST(TimerInterrupts, CapturesInTheStateOfTheEdge) {
  for (const unsigned n : {0u, 1u, 2u, 3u}) {
    for (const bool rising : {false, true}) {
      Program p;
      p.modules_on().out8(0xffff96, rising ? static_cast<std::uint8_t>(0x80u >> n) : 0);
      p.out8(0xffff90, static_cast<std::uint8_t>(0x80u >> n)).enable_interrupts();
      const std::uint32_t ready = end_of(p);
      p.nops(200).stay();
      Chip chip = make_chip(p);
      const int bit = 2 + static_cast<int>(n);
      chip.set_input(Port::p6, bit, !rising);
      ASSERT_TRUE(run_to(chip, ready));
      chip.run_until(chip.now() + 40);
      EXPECT_EQ(chip.peek(0xffff91), 0x00);
      chip.set_input(Port::p6, bit, rising);
      const States edge = chip.now();
      EXPECT_EQ(chip.peek16(0xffff98 + 2 * n), chip.peek16(0xffff92)) << n;
      ASSERT_TRUE(run_to(chip, handler(48 + n)));
      EXPECT_EQ(chip.now(), edge + kToHandler);
      chip.run_until(chip.now() + 100);
    }
  }
}

// ICIX comes with the falling edge that ends the measurement.
TEST(TimerInterrupts, MeasurementEndsWithItsEdge) {
  Program p;
  p.modules_on().out8(kTconrs, 0x80).out8(0xfffff1, 0x10).out8(kTconrs, 0x00);
  p.out8(0xfffff0, 1).out8(kTconri, 0x10).enable_interrupts();
  const std::uint32_t ready = end_of(p);
  p.nops(200).stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, ready));
  chip.run_until(chip.now() + 20);
  chip.set_input(Port::p6, 0, true);
  chip.run_until(chip.now() + 60);
  EXPECT_EQ(chip.peek(0xfffff1).value() & 0x10, 0);
  chip.set_input(Port::p6, 0, false);
  const States edge = chip.now();
  ASSERT_TRUE(run_to(chip, handler(75)));
  EXPECT_EQ(chip.now(), edge + kToHandler);
  // TMRX counts each state: the width in its counts, rise to fall.
  EXPECT_EQ(static_cast<std::uint8_t>(chip.peek(0xfffff3).value() - chip.peek(0xfffff2).value()),
            60);
}

// Compare match A of TMR0 starts the A/D (ADCR.TRGS = 10) where TCSR0.ADTE is set.
TEST(TimerInterrupts, MatchAStartsTheConverter) {
  for (const bool adte : {false, true}) {
    Program p;
    p.modules_on().out8(0xffffe9, 0xbf).out8(0xffffcc, 9).out8(0xffffca, adte ? 0x10 : 0x00);
    p.out8(0xffffc8, 0x01);
    const std::uint32_t begun = end_of(p);
    p.nops(200).stay();
    Chip chip = make_chip(p);
    ASSERT_TRUE(run_to(chip, begun));
    const States match = (chip.now() / 8 + 10) * 8;
    chip.run_until(match - 1);
    EXPECT_EQ(chip.peek(0xffffe8).value() & 0x20, 0);  // ADST
    chip.run_until(match);
    EXPECT_EQ(chip.peek(0xffffe8).value() & 0x20, adte ? 0x20 : 0);
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
