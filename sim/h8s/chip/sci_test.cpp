// Serial channel: byte timing, double buffering, error rules, flags.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kSmr = 0xffffd8, kBrr = 0xffffd9, kScr = 0xffffda, kTdr = 0xffffdb,
                        kSsr = 0xffffdc, kRdr = 0xffffdd;
// 115,200 baud at 18.432 MHz: N = 4, 160 states a bit, 1600 a byte.
constexpr States kByte = 1600;

Program serial(std::uint8_t scr) {
  Program p;
  p.modules_on().out8(kSmr, 0x00).out8(kBrr, 4).out8(kScr, scr);
  return p;
}

// Reads SSR, writes TDR, clears TDRE.
Program& send(Program& p, std::uint8_t value) {
  return p.out8(kTdr, value).in8(kSsr).words({0x7f00 | (kSsr & 0xff), 0x7270});
}

std::vector<TransmittedByte> run_and_record(Chip& chip, States until) {
  std::vector<TransmittedByte> sent;
  chip.on_transmit([&](int n, const TransmittedByte& b) {
    EXPECT_EQ(n, 0);
    sent.push_back(b);
  });
  EXPECT_EQ(chip.run_until(until).reason, Stop::Reason::reached);
  chip.on_transmit(nullptr);
  return sent;
}

TEST(SciTransmit, BytesFollowWithoutGap) {
  Program p = serial(0x20);
  send(p, 0x55);
  p.nops(40);
  send(p, 0xa3);
  p.stay();
  Options options;
  options.sci_preamble = false;
  Chip chip = make_chip(p, options);
  const auto sent = run_and_record(chip, 5000);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[0].value, 0x55);
  EXPECT_EQ(sent[0].end - sent[0].start, kByte);
  EXPECT_EQ(sent[1].value, 0xa3);
  EXPECT_EQ(sent[1].start, sent[0].end);
  EXPECT_EQ(sent[1].end - sent[1].start, kByte);
}

TEST(SciTransmit, PreambleOfOneFramePrecedesTheFirstByte) {
  Program p = serial(0x20);
  send(p, 0x01);
  p.stay();
  Options without;
  without.sci_preamble = false;
  Chip plain = make_chip(p, without), chip = make_chip(p);
  const auto early = run_and_record(plain, 6000), late = run_and_record(chip, 6000);
  ASSERT_EQ(early.size(), 1u);
  ASSERT_EQ(late.size(), 1u);
  EXPECT_GT(late[0].start - early[0].start, kByte - 60);
  EXPECT_LT(late[0].start - early[0].start, kByte);
}

TEST(SciTransmit, WritingTdrAloneSendsNothing) {
  Program p = serial(0x20);
  p.out8(kTdr, 0x55).out8(kSsr, 0x00);  // TDRE was never read as 1
  p.stay();
  Chip chip = make_chip(p);
  EXPECT_TRUE(run_and_record(chip, 10'000).empty());
}

TEST(SciTransmit, WaveformAtThePin) {
  Program p = serial(0x20);
  send(p, 0xc1);
  p.stay();
  Options options;
  options.sci_preamble = false;
  Chip chip = make_chip(p, options);
  chip.run_until(80);
  std::vector<TransmittedByte> sent;
  chip.on_transmit([&](int, const TransmittedByte& b) { sent.push_back(b); });
  Chip ahead = chip.clone();
  chip.run_until(5000);
  ASSERT_EQ(sent.size(), 1u);
  const int bits[10] = {0, 1, 0, 0, 0, 0, 0, 1, 1, 1};
  for (int k = 0; k < 10; ++k) {
    ahead.run_until(sent[0].start + 160 * k + 80);
    EXPECT_EQ(ahead.output(Port::p5).level & 1, bits[k]) << k;
  }
}

TEST(SciTransmit, InterruptsOnEmptyRegister) {
  Program p = serial(0xa0);  // TIE: TDRE is set already
  p.enable_interrupts().stay();
  Chip chip = make_chip(p);
  EXPECT_TRUE(run_to(chip, handler(82)));
}

TEST(SciReceive, FlagAndInterruptAtTheStopBit) {
  Program p = serial(0x50);
  p.enable_interrupts().stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(chip.receive(0, {0x42, 3000}).has_value());
  while (chip.now() < 2998) chip.step();  // `bra .` ends at every second state
  ASSERT_LT(chip.now(), 3000);
  EXPECT_EQ(chip.peek(kSsr).value() & 0x40, 0);
  chip.run_until(3000);
  EXPECT_EQ(chip.peek(kSsr).value() & 0x40, 0x40);
  EXPECT_EQ(chip.peek(kRdr), 0x42);
  ASSERT_TRUE(run_to(chip, handler(81)));
  EXPECT_NEAR(chip.now(), 3000 + 4 + 8, 1);
}

TEST(SciReceive, OverrunKeepsTheFirstByteAndBlocks) {
  Program p = serial(0x10);
  p.stay();
  Chip chip = make_chip(p);
  for (States k = 1; k <= 3; ++k)
    ASSERT_TRUE(chip.receive(0, {static_cast<std::uint8_t>(k), 2000 * k}).has_value());
  chip.run_until(7000);
  EXPECT_EQ(chip.peek(kRdr), 1);
  EXPECT_EQ(chip.peek(kSsr).value() & 0x78, 0x60);  // RDRF, ORER
}

TEST(SciReceive, FramingErrorCopiesWithoutRdrf) {
  Program p = serial(0x50);
  p.enable_interrupts().stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(chip.receive(0, {0x99, 2000, true}).has_value());
  ASSERT_TRUE(run_to(chip, handler(80)));
  EXPECT_EQ(chip.peek(kRdr), 0x99);
  EXPECT_EQ(chip.peek(kSsr).value() & 0x78, 0x10);
}

TEST(SciReceive, OrderAndTimesAreChecked) {
  Chip chip = make_chip(Program().stay());
  chip.run_until(100);
  EXPECT_FALSE(chip.receive(0, {1, 50}).has_value());
  EXPECT_TRUE(chip.receive(0, {1, 500}).has_value());
  EXPECT_FALSE(chip.receive(0, {1, 499}).has_value());
  EXPECT_FALSE(chip.receive(2, {1, 600}).has_value());
}

TEST(Sci, ModuleStopResetsAndReportsAccess) {
  Program p = serial(0x30);
  p.out16(kMstpcr, 0x3fff).out8(kBrr, 7).stay();
  Chip chip = make_chip(p);
  chip.run_until(200);
  EXPECT_EQ(chip.peek(kBrr), 0xff);
  EXPECT_EQ(chip.peek(kScr), 0x00);
  ASSERT_EQ(chip.misuse().size(), 1u);
  EXPECT_EQ(chip.misuse()[0].address, kBrr);
}

}  // namespace
}  // namespace kaz::h8s::testing
