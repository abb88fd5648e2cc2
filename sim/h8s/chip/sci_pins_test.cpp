// Serial channel at its pins: waveforms out, reception from levels, against whole bytes.
// SPDX-License-Identifier: Apache-2.0
#include <bit>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/chip/machine.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kSmr = 0xffffd8, kBrr = 0xffffd9, kScr = 0xffffda, kTdr = 0xffffdb,
                        kSsr = 0xffffdc, kRdr = 0xffffdd, kScmr = 0xffffde;
constexpr States kBit = 160;  // N = 4

Chip listening(std::uint8_t smr, std::uint8_t scr, std::uint8_t scmr = 0xf2, Options o = {}) {
  Program p;
  p.modules_on().out8(kSmr, smr).out8(kScmr, scmr).out8(kBrr, 4).out8(kScr, scr);
  // Reading SSR arms the clearing of its flags by clear_flags().
  const std::uint32_t loop = end_of(p);
  p.in8(kSsr).words({0x5a00, static_cast<std::uint16_t>(loop)});
  Chip chip = make_chip(p, o);
  chip.set_input(Port::p5, 1, true);
  chip.run_until(1000);
  return chip;
}

void drive(Chip& chip, bool level, States until) {
  chip.set_input(Port::p5, 1, level);
  chip.run_until(until);
}

// Sends the bits of a frame, each `bit` states long, from about now; returns the start time.
States send_bits(Chip& chip, unsigned bits, int count, double bit) {
  const States start = chip.now();
  for (int k = 0; k < count; ++k)
    drive(chip, bits >> k & 1, start + static_cast<States>((k + 1) * bit));
  chip.set_input(Port::p5, 1, true);
  return start;
}

unsigned frame(std::uint8_t byte, int data = 8, int parity = -1) {
  unsigned bits = (byte & ((1u << data) - 1)) << 1;
  int k = 1 + data;
  if (parity >= 0) bits |= static_cast<unsigned>(parity) << k++;
  return bits | 3u << k;
}

std::uint8_t flags(const Chip& chip) {
  return chip.peek(kSsr).value() & 0x78;
}

// Reception of bytes and of levels has the same effect on the registers in every format, at the same state.
TEST(SciPins, LevelsAndWholeBytesGiveTheSame) {
  for (const std::uint8_t smr : {0x00, 0x40, 0x20, 0x30, 0x08, 0x60, 0x78}) {
    for (const std::uint8_t scmr : {0xf2, 0xfa, 0xf6, 0xfe}) {
      const int data = smr & 0x40 ? 7 : 8, parity_bits = smr & 0x20 ? 1 : 0;
      const int count = 1 + data + parity_bits + (smr & 8 ? 2 : 1);
      const std::uint8_t wire = smr & 0x40 ? 0x35 : 0xb5;
      const int parity = parity_bits ? (std::popcount(wire) & 1) ^ (smr & 0x10 ? 1 : 0) : -1;
      Chip a = listening(smr, 0x10, scmr);
      Chip b = a.clone();
      const States start = a.now();
      ASSERT_TRUE(b.receive(0, {wire, start + count * kBit}).has_value());
      // Until just before the end: neither has it.
      const unsigned bits = frame(wire, data, parity);
      for (int k = 0; k < count - 1; ++k) drive(a, bits >> k & 1, start + (k + 1) * kBit);
      drive(a, true, start + count * kBit - 20);
      b.run_until(start + count * kBit - 20);
      EXPECT_EQ(flags(a), 0);
      EXPECT_EQ(flags(b), 0);
      a.run_until(start + count * kBit);
      b.run_until(start + count * kBit);
      EXPECT_EQ(flags(a), 0x40) << int{smr};
      EXPECT_EQ(flags(b), 0x40);
      EXPECT_EQ(a.peek(kRdr), b.peek(kRdr));
      if (scmr == 0xf2) {
        EXPECT_EQ(a.peek(kRdr), wire);
      }
    }
  }
}

TEST(SciPins, ReadyAtTheStopSampleByOption) {
  Options o;
  o.sci_ready_mid_stop = true;
  Chip chip = listening(0, 0x10, 0xf2, o);
  const States start = chip.now();
  const unsigned bits = frame(0x5a);
  for (int k = 0; k < 9; ++k) drive(chip, bits >> k & 1, start + (k + 1) * kBit);
  chip.set_input(Port::p5, 1, true);
  chip.run_until(start + 9 * kBit + kBit * 6 / 16 - 12);
  EXPECT_EQ(flags(chip), 0);
  chip.run_until(start + 9 * kBit + kBit / 2 + 12);
  EXPECT_EQ(flags(chip), 0x40);
}

// 8N1 takes a sender that is 4 % off and not one that is 8 % off (margin: 46.9 % of a bit in 9.5).
TEST(SciPins, WrongRatesAreSeen) {
  for (const double rate : {0.96, 1.0, 1.04}) {
    Chip chip = listening(0, 0x10);
    send_bits(chip, frame(0x00), 11, kBit * rate);
    chip.run_until(chip.now() + 2 * kBit);
    EXPECT_EQ(flags(chip), 0x40) << rate;
    EXPECT_EQ(chip.peek(kRdr), 0x00);
  }
  Chip slow = listening(0, 0x10);
  send_bits(slow, frame(0x00), 10, kBit * 1.08);
  slow.run_until(slow.now() + 2 * kBit);
  EXPECT_EQ(flags(slow), 0x10);  // the last 0 is where the stop bit should be
  Chip fast = listening(0, 0x10);
  send_bits(fast, frame(0x7f), 10, kBit * 0.92);
  fast.run_until(fast.now() + 2 * kBit);
  EXPECT_NE(fast.peek(kRdr), 0x7f);  // bit 7 shows the stop bit
}

TEST(SciPins, FalseStartBitIsDropped) {
  Chip chip = listening(0, 0x10);
  const States start = chip.now();
  drive(chip, false, start + kBit * 6 / 16);
  drive(chip, true, start + 20 * kBit);
  EXPECT_EQ(flags(chip), 0);
  send_bits(chip, frame(0x42), 10, kBit);
  chip.run_until(chip.now() + kBit);
  EXPECT_EQ(chip.peek(kRdr), 0x42);
}

TEST(SciPins, BreakGivesOneFramingErrorAndBlocks) {
  Chip chip = listening(0, 0x10);
  drive(chip, false, chip.now() + 40 * kBit);
  EXPECT_EQ(flags(chip), 0x10);
  EXPECT_EQ(chip.peek(kRdr), 0x00);
  drive(chip, true, chip.now() + 2 * kBit);
  send_bits(chip, frame(0x42), 10, kBit);
  chip.run_until(chip.now() + kBit);
  EXPECT_EQ(flags(chip), 0x10);
  EXPECT_EQ(chip.peek(kRdr), 0x00);
}

TEST(SciPins, ParityErrorCopiesWithoutRdrf) {
  Chip chip = listening(0x20, 0x10);
  send_bits(chip, frame(0x03, 8, 1), 11, kBit);
  chip.run_until(chip.now() + kBit);
  EXPECT_EQ(flags(chip), 0x08);
  EXPECT_EQ(chip.peek(kRdr), 0x03);
}

// Overrun with a bad frame: all flags, and RDR keeps the first byte.
TEST(SciPins, OverrunTogetherWithParityAndFraming) {
  Chip chip = listening(0x20, 0x10);
  send_bits(chip, frame(0x11, 8, 0), 11, kBit);
  send_bits(chip, 0x06 | 1u << 9, 11, kBit);  // data 3, wrong parity, stop bit 0
  chip.run_until(chip.now() + kBit);
  EXPECT_EQ(flags(chip), 0x78);
  EXPECT_EQ(chip.peek(kRdr), 0x11);
}

TEST(SciPins, MultiprocessorWaitsForItsId) {
  for (const bool pins : {false, true}) {
    Chip chip = listening(0x04, 0x18);
    const auto give = [&](std::uint8_t byte, bool id) {
      if (pins) {
        send_bits(chip, frame(byte, 8, id ? 1 : 0), 11, kBit);
      } else {
        const ReceivedByte b{byte, chip.now() + 11 * kBit, false, false, id};
        ASSERT_TRUE(chip.receive(0, b).has_value());
      }
      chip.run_until(chip.now() + 12 * kBit);
    };
    give(0x21, false);
    EXPECT_EQ(flags(chip), 0);
    give(0x22, true);
    EXPECT_EQ(flags(chip), 0x40);
    EXPECT_EQ(chip.peek(kRdr), 0x22);
    EXPECT_EQ(chip.peek(kSsr).value() & 2, 2);
    EXPECT_EQ(chip.peek(kScr).value() & 8, 0);
  }
}

// --- out

// Sends `byte` after the SCR write and stays.
Chip sending(std::uint8_t smr, std::uint8_t scr, std::uint8_t byte, std::uint8_t scmr = 0xf2) {
  Program p;
  p.modules_on().out8(kSmr, smr).out8(kScmr, scmr).out8(kBrr, 4).out8(kScr, scr);
  p.out8(kTdr, byte).in8(kSsr).words({0x7f00 | (kSsr & 0xff), 0x7270}).stay();
  Options o;
  o.sci_preamble = false;
  return make_chip(p, o);
}

struct Sent {
  Chip chip;
  States start;
};
Sent begun(Chip chip) {
  States start = -1;
  chip.on_output([&](const OutputChange& c) {
    if (c.unit == OutputChange::Unit::serial) start = c.at;
  });
  for (int k = 0; k < 400 && start < 0; ++k) chip.step();
  chip.on_output(nullptr);
  EXPECT_GE(start, 0);
  return {std::move(chip), start};
}

// Levels of one frame, read at the pin in the middle of each bit.
unsigned levels(Sent& s, int count, States bit, std::uint8_t mask = 1) {
  unsigned bits = 0;
  for (int k = 0; k < count; ++k) {
    s.chip.run_until(s.start + k * bit + bit / 2 - 4);
    bits |= (s.chip.output(Port::p5).level & mask ? 1u : 0u) << k;
  }
  return bits;
}

TEST(SciPins, FramesOutInEachFormat) {
  struct Case {
    std::uint8_t smr, scmr, byte;
    int count;
    unsigned bits;
  };
  // Start bit 0 first, then data from bit 0.
  for (const Case c :
       {Case{0x00, 0xf2, 0xc1, 10, 0x200 | 0xc1 << 1}, Case{0x40, 0xf2, 0xc1, 9, 0x100 | 0x41 << 1},
        Case{0x20, 0xf2, 0xc1, 11, 0x400 | 0x200 | 0xc1 << 1},  // even: three 1s
        Case{0x30, 0xf2, 0xc1, 11, 0x400 | 0xc1 << 1},
        Case{0x08, 0xf2, 0xc1, 11, 0x600 | 0xc1 << 1},
        Case{0x00, 0xfa, 0xc1, 10, 0x200 | 0x83 << 1},  // most significant first
        Case{0x00, 0xf6, 0xc1, 10, 0x200 | 0x3e << 1},
        Case{0x04, 0xf2, 0xc1, 11, 0x400 | 0xc1 << 1}}) {
    Sent s = begun(sending(c.smr, 0x20, c.byte, c.scmr));
    EXPECT_EQ(levels(s, c.count, kBit), c.bits) << int{c.smr} << ' ' << int{c.scmr};
    s.chip.run_until(s.start + c.count * kBit - 4);
    EXPECT_EQ(s.chip.peek(kSsr).value() & 4, 0);
    s.chip.run_until(s.start + c.count * kBit);
    EXPECT_EQ(s.chip.peek(kSsr).value() & 4, 4);
  }
}

// Clocked: data change at falling edges of SCK, which rests high; 4 (N + 1) states a bit.
TEST(SciPins, ClockedFrameWithItsClock) {
  Sent s = begun(sending(0x80, 0x20, 0x5c));
  constexpr States bit = 20;
  for (int k = 0; k < 8; ++k) {
    s.chip.run_until(s.start + k * bit + 4);
    EXPECT_EQ(s.chip.output(Port::p5).level, (0x5c >> k & 1)) << k;  // SCK low
    s.chip.run_until(s.start + k * bit + 14);
    EXPECT_EQ(s.chip.output(Port::p5).level, 4 | (0x5c >> k & 1)) << k;
  }
  s.chip.run_until(s.start + 8 * bit + 4);
  EXPECT_EQ(s.chip.output(Port::p5).level, 4);  // both as the last bit left them
  EXPECT_EQ(s.chip.output(Port::p5).driven, 5);
}

// CKE = 01: the bit clock is on SCK all the time; it rises in the middle of each data bit.
TEST(SciPins, BitClockRisesInTheMiddleOfTheBit) {
  Sent s = begun(sending(0x00, 0x21, 0xff));
  s.chip.run_until(s.start + kBit + kBit / 2 - 4);
  EXPECT_EQ(s.chip.output(Port::p5).level & 4, 0);
  s.chip.run_until(s.start + kBit + kBit / 2 + 2);
  EXPECT_EQ(s.chip.output(Port::p5).level & 4, 4);
  s.chip.run_until(s.start + 30 * kBit + kBit / 2 + 2);
  EXPECT_EQ(s.chip.output(Port::p5).level & 4, 4);
}

// TE = 0 in the middle of a frame: the pin is the port's at once, here low: a break.
TEST(SciPins, TeOffLeavesThePinToThePort) {
  Program p;
  p.modules_on().out8(0xffffb8, 0x01).out8(kBrr, 4).out8(kScr, 0x20);
  p.out8(kTdr, 0xff).in8(kSsr).words({0x7f00 | (kSsr & 0xff), 0x7270});
  p.nops(1000).out8(kScr, 0x00).stay();
  Chip chip = make_chip(p);
  chip.run_until(1000);
  EXPECT_EQ(chip.output(Port::p5).level & 1, 1);
  chip.run_until(3000);
  EXPECT_EQ(chip.output(Port::p5).level & 1, 0);
  EXPECT_EQ(chip.output(Port::p5).driven & 1, 1);
}

// Sixteen clocks from the board make a bit.
TEST(SciPins, OutsideClockOfSixteenABit) {
  Chip out = sending(0x00, 0x32, 0x96);
  out.run_until(400);
  out.set_input(Port::p5, 2, false);
  out.set_input(Port::p5, 1, true);
  unsigned sent = 0;
  const unsigned in = 0x3a << 1 | 0x600;
  for (int bit = 0; bit < 11; ++bit) {
    for (int k = 0; k < 16; ++k) {
      if (k == 1) out.set_input(Port::p5, 1, in >> bit & 1);
      out.set_input(Port::p5, 2, true);
      out.run_until(out.now() + 6);
      if (k == 8) sent |= static_cast<unsigned>(out.output(Port::p5).level & 1) << bit;
      out.set_input(Port::p5, 2, false);
      out.run_until(out.now() + 6);
    }
  }
  EXPECT_EQ(sent, 0x600u | 0x96 << 1);
  EXPECT_EQ(out.peek(kRdr), 0x3a);
  EXPECT_EQ(flags(out), 0x40);
}

// Clocked by the board: bits go out at falling edges and come in at rising ones.
TEST(SciPins, ClockedByTheBoard) {
  Chip chip = sending(0x80, 0x32, 0x96);
  chip.set_input(Port::p5, 2, true);
  chip.set_input(Port::p5, 1, true);
  chip.run_until(400);
  unsigned sent = 0;
  for (int k = 0; k < 8; ++k) {
    chip.set_input(Port::p5, 2, false);
    chip.set_input(Port::p5, 1, 0xa7 >> k & 1);
    chip.run_until(chip.now() + 10);
    sent |= static_cast<unsigned>(chip.output(Port::p5).level & 1) << k;
    EXPECT_EQ(flags(chip), 0);
    chip.set_input(Port::p5, 2, true);
    chip.run_until(chip.now() + 10);
  }
  EXPECT_EQ(sent, 0x96u);
  EXPECT_EQ(chip.peek(kRdr), 0xa7);
  EXPECT_EQ(chip.peek(kSsr).value() & 0x44, 0x44);  // RDRF and TEND
}

// Reception alone makes clocks until the overrun.
TEST(SciPins, ClockedReceptionRunsUntilOverrun) {
  Chip chip = listening(0x80, 0x10);
  EXPECT_EQ(chip.peek(kRdr), 0xff);
  EXPECT_EQ(flags(chip), 0x60);
  EXPECT_EQ(chip.output(Port::p5).level & 4, 4);
}

// The predicted waveform: each change is where the level does change.
TEST(SciPins, ChangesAreKnownAhead) {
  struct Case {
    std::uint8_t smr, scr;
    States bit;
    std::vector<States> txd, sck;  // in half bits from the start
  };
  const Case cases[] = {
      {0x00, 0x20, 160, {0, 2, 4, 16}, {}},
      {0x80, 0x20, 20, {2, 14}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}}};
  for (const Case& c : cases) {
    Options o;
    Machine m(o);
    m.io_write(kMstpcr, 0);
    m.io_write(kMstpcr + 1, 0);
    o.sci_preamble = false;
    m.options = o;
    m.io_write(kSmr, c.smr);
    m.io_write(kBrr, 4);
    m.io_write(kScr, c.scr);
    m.io_write(kTdr, 0x81);
    m.io_read(kSsr);
    m.io_write(kSsr, 0x00);
    std::vector<States> txd, sck;
    for (States t = -1; (t = m.sci[0].txd_change(t)) != kNever;) txd.push_back(2 * t / c.bit);
    for (States t = -1; (t = m.sci[0].sck_change(t)) != kNever;) sck.push_back(2 * t / c.bit);
    EXPECT_EQ(txd, c.txd);
    EXPECT_EQ(sck, c.sck);
  }
}

// A frame that follows another begins on the bit's boundary at the pin too, also where the program
// writes a register in that very state.
TEST(SciPins, StartBitOfTheNextFrameIsOnTimeWhateverIsWritten) {
  for (int shift = 0; shift < 12; ++shift) {
    Program p;
    p.modules_on().out8(kBrr, 4).out8(kScr, 0x20);
    for (int byte = 0; byte < 2; ++byte) {
      p.out8(kTdr, 0x55).in8(kSsr).out8(kSsr, 0x04);
      p.nops(byte == 0 ? 1900 : shift);  // behind the preamble, a frame long
    }
    // mov.b r0l,@P3DDR:16, and again
    const std::uint32_t loop = end_of(p);
    p.words({0x6a88, 0xffb4, 0x5a00, static_cast<std::uint16_t>(loop)});
    Chip chip = make_chip(p);
    std::vector<States> edges;
    chip.watch(Pin::p50, [&edges](const PinEdge& e) { edges.push_back(e.at); });
    chip.run_until(50 * kBit);
    ASSERT_GE(edges.size(), 20u) << shift;
    const States first = edges[edges.size() - 20];
    for (std::size_t k = edges.size() - 20; k < edges.size(); ++k)
      EXPECT_EQ((edges[k] - first) % kBit, 0) << "edge " << k << ", shift " << shift;
  }
}

}  // namespace
}  // namespace kaz::h8s::testing
