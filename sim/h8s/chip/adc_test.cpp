// A/D converter: sampling instant, conversion time, single and scan mode, result format.
// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kAddra = 0xffffe0, kAdcsr = 0xffffe8;

struct Sample {
  int channel;
  States at;
};

struct Conversion {
  Chip chip;
  States start;  // end of the write that set ADST
};

Conversion started(std::uint8_t adcsr, std::vector<Sample>& samples) {
  Program p;
  p.modules_on().out8(kAdcsr, adcsr);
  const std::uint32_t at = end_of(p);
  p.stay();
  Chip chip = make_chip(p);
  chip.set_analog([&samples](int channel, States when) {
    samples.push_back({channel, when});
    return 0.125 * channel + 0.0625;
  });
  EXPECT_TRUE(run_to(chip, at));
  const States start = chip.now();
  return {std::move(chip), start};
}

TEST(Adc, SingleConversionSamplesAndEndsOnTime) {
  struct Case {
    std::uint8_t cks;
    States sample, end;
  };
  for (const Case c : {Case{0x00, 17 + 63, 266}, Case{0x08, 9 + 31, 134}}) {
    std::vector<Sample> samples;
    Conversion run = started(static_cast<std::uint8_t>(0x23 | c.cks), samples);
    run.chip.run_until(run.start + c.end - 2);
    EXPECT_EQ(run.chip.peek(kAdcsr).value() & 0xa0, 0x20);
    run.chip.run_until(run.start + c.end + 2);
    EXPECT_EQ(run.chip.peek(kAdcsr).value() & 0xa0, 0x80);
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_EQ(samples[0].channel, 3);
    EXPECT_EQ(samples[0].at, run.start + c.sample);
    // 0.4375 * 1024 = 448, left-aligned, in ADDRD.
    EXPECT_EQ(run.chip.peek16(kAddra + 6), 448 << 6);
  }
}

TEST(Adc, ScanGoesRoundAndFlagsAfterTheLast) {
  std::vector<Sample> samples;
  Conversion run = started(0x3a, samples);  // scan AN0..AN2, fast
  run.chip.run_until(run.start + 134 + 128 + 120);
  EXPECT_EQ(run.chip.peek(kAdcsr).value() & 0x80, 0x00);
  run.chip.run_until(run.start + 134 + 2 * 128 + 4);
  EXPECT_EQ(run.chip.peek(kAdcsr).value() & 0x80, 0x80);
  run.chip.run_until(run.start + 134 + 5 * 128 + 4);
  ASSERT_GE(samples.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(samples[k].channel, static_cast<int>(k % 3));
  EXPECT_EQ(samples[2].at - samples[1].at, 128);
}

TEST(Adc, InterruptAtTheEnd) {
  Program p;
  p.modules_on().out8(kAdcsr, 0x68).enable_interrupts().stay();
  Chip chip = make_chip(p);
  ASSERT_TRUE(run_to(chip, handler(28)));
}

TEST(Adc, ResultIsCutDownAndClipped) {
  for (const auto& [share, code] :
       {std::pair{-0.5, 0}, {0.9999, 1023}, {1.5, 1023}, {0.5, 512}, {0.49999, 511}}) {
    Program p;
    p.modules_on().out8(kAdcsr, 0x28).stay();
    Chip chip = make_chip(p);
    chip.set_analog([v = share](int, States) { return v; });
    chip.run_until(400);
    EXPECT_EQ(chip.peek16(kAddra).value() >> 6, code);
  }
}

// A steady source: the same results in the same states, with fewer samples. Port 1 changes every 1,500
// states, and the source depends on it.
TEST(Adc, OfASteadySourceOnlyWhatIsReadIsSampled) {
  constexpr std::uint32_t port1_direction = 0xffffb0, port1 = 0xffffb2;
  for (const std::uint8_t adcsr : {0x32, 0x3b, 0x35, 0x72}) {
    Program p;
    p.modules_on().out8(port1_direction, 0xff).out8(kAdcsr, adcsr);
    const auto loop = static_cast<std::uint16_t>(end_of(p));
    for (const std::uint8_t level : {1, 0})
      p.out8(port1, level)
          .words({0x7901, 500, 0x1b51, 0x46fc});  // mov.w #500,r1 ; dec.w #1,r1 ; bne
    p.words({0x5a00, loop});
    struct Board {
      Chip chip;
      bool level = false;
      int samples = 0;
    };
    Board boards[] = {{make_chip(p)}, {make_chip(p)}};
    for (Board& b : boards) {
      b.chip.on_output(
          [&b](const OutputChange&) { b.level = (b.chip.output(Port::p1).level & 1) != 0; });
      b.chip.set_analog(
          [&b](int channel, States at) {
            ++b.samples;
            return (static_cast<double>((at / 64 + channel * 31) % 128) + (b.level ? 128 : 0)) /
                   256;
          },
          &b == &boards[1]);
    }
    std::mt19937 random(adcsr);
    for (int slice = 0; slice < 200; ++slice) {
      const States to = boards[0].chip.now() + 1 + static_cast<States>(random() % 4000);
      for (Board& b : boards) ASSERT_EQ(b.chip.run_until(to).reason, Stop::Reason::reached);
      ASSERT_EQ(boards[0].chip.now(), boards[1].chip.now());
      for (std::uint32_t at = kAddra; at <= kAdcsr; ++at)
        ASSERT_EQ(boards[0].chip.peek(at), boards[1].chip.peek(at)) << std::hex << at;
    }
    EXPECT_LT(boards[1].samples, boards[0].samples);
    EXPECT_GT(boards[1].samples, boards[0].samples / 8);
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
