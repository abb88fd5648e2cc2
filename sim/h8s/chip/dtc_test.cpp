// Data transfer controller: modes, chains, ends of counts, flags, time taken from the CPU.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kDtcera = 0xfffeee, kDtcerc = 0xfffef0, kDtvecr = 0xfffef3,
                        kIscrl = 0xfffeed, kIer = 0xffffc2;
constexpr std::uint32_t kSmr = 0xffffd8, kBrr = 0xffffd9, kScr = 0xffffda, kTdr = 0xffffdb,
                        kSsr = 0xffffdc, kRdr = 0xffffdd;
constexpr std::uint32_t kBlock0 = 0xffec00, kFrom = 0xffe200, kTo = 0xffe400;

// MRA.
constexpr std::uint8_t kSourceUp = 0x80, kSourceDown = 0xc0, kTargetUp = 0x20, kTargetDown = 0x30,
                       kRepeat = 0x04, kBlockMode = 0x08, kAreaIsSource = 0x02, kWord = 0x01;
// MRB.
constexpr std::uint8_t kChain = 0x80, kAlwaysInterrupt = 0x40;

struct Info {
  std::uint8_t mra, mrb;
  std::uint32_t sar, dar;
  std::uint16_t cra, crb = 0;
};

void put(Chip& chip, std::uint32_t at, const Info& i) {
  const std::uint8_t bytes[12] = {i.mra,
                                  static_cast<std::uint8_t>(i.sar >> 16),
                                  static_cast<std::uint8_t>(i.sar >> 8),
                                  static_cast<std::uint8_t>(i.sar),
                                  i.mrb,
                                  static_cast<std::uint8_t>(i.dar >> 16),
                                  static_cast<std::uint8_t>(i.dar >> 8),
                                  static_cast<std::uint8_t>(i.dar),
                                  static_cast<std::uint8_t>(i.cra >> 8),
                                  static_cast<std::uint8_t>(i.cra),
                                  static_cast<std::uint8_t>(i.crb >> 8),
                                  static_cast<std::uint8_t>(i.crb)};
  ASSERT_TRUE(chip.poke(at, bytes));
}
std::uint32_t sar(const Chip& c, std::uint32_t at) {
  return c.peek32(at).value() & 0xffffff;
}
std::uint32_t dar(const Chip& c, std::uint32_t at) {
  return c.peek32(at + 4).value() & 0xffffff;
}
unsigned cra(const Chip& c, std::uint32_t at) {
  return c.peek16(at + 8).value();
}
unsigned crb(const Chip& c, std::uint32_t at) {
  return c.peek16(at + 10).value();
}

void set_vector(Chip& chip, unsigned vector, std::uint32_t block) {
  ASSERT_TRUE(chip.poke(0x400 + 2 * vector, static_cast<std::uint8_t>(block >> 8)));
  ASSERT_TRUE(chip.poke(0x401 + 2 * vector, static_cast<std::uint8_t>(block)));
}

// Nops, with IRQ0 on falling edges enabled and assigned to the DTC; interrupts masked until later.
Chip irq_chip(bool interrupts = false, Options o = {}) {
  Program p;
  p.modules_on().out8(kIscrl, 0x01).out8(kIer, 0x01).out8(kDtcera, 0x80);
  if (interrupts) p.enable_interrupts();
  const std::uint32_t nops = end_of(p);
  p.nops(3000).stay();
  Chip chip = make_chip(p, o);
  chip.set_input(Port::p4, 2, true);
  EXPECT_TRUE(run_to(chip, nops + 8));
  set_vector(chip, 16, kBlock0);
  std::array<std::uint8_t, 64> data;
  for (unsigned k = 0; k < data.size(); ++k) data[k] = static_cast<std::uint8_t>(0x40 + k);
  EXPECT_TRUE(chip.poke(kFrom, data));
  return chip;
}

void request(Chip& chip) {
  chip.set_input(Port::p4, 2, false);
  chip.set_input(Port::p4, 2, true);
}
// Gives the states that the activation took from the CPU: 100 nops need 100 without it.
States activate(Chip& chip) {
  const std::uint32_t pc = chip.registers().pc;
  const States start = chip.now();
  request(chip);
  EXPECT_TRUE(run_to(chip, pc + 200));
  return chip.now() - start - 100;
}

// Vector 1, information 6, data 1 + 1, internal 3.
TEST(Dtc, NormalModeMovesCountsAndTakesTwelveStates) {
  Chip chip = irq_chip();
  put(chip, kBlock0, {kSourceUp | kTargetUp, 0, kFrom, kTo, 3});
  EXPECT_EQ(activate(chip), 12);
  EXPECT_EQ(chip.peek(kTo), 0x40);
  EXPECT_EQ(chip.peek(kTo + 1), 0xa5);
  EXPECT_EQ(sar(chip, kBlock0), kFrom + 1);
  EXPECT_EQ(dar(chip, kBlock0), kTo + 1);
  EXPECT_EQ(cra(chip, kBlock0), 2u);
  EXPECT_EQ(chip.peek(0xfffeeb).value() & 1, 0);  // IRQ0F
  EXPECT_EQ(chip.peek(kDtcera), 0x80);
}

// A request is served at the first boundary later than 3 states after it, like an interrupt.
TEST(Dtc, BeginsAfterTheDecision) {
  Chip chip = irq_chip();
  put(chip, kBlock0, {kSourceUp | kTargetUp, 0, kFrom, kTo, 3});
  request(chip);
  const States edge = chip.now();
  chip.run_until(edge + 4);
  EXPECT_EQ(chip.now(), edge + 4);
  EXPECT_EQ(chip.peek(kTo), 0xa5);
  chip.step();
  EXPECT_EQ(chip.now(), edge + 4 + 12);
  EXPECT_EQ(chip.peek(kTo), 0x40);
}

TEST(Dtc, AddressModesAndSizes) {
  struct Case {
    std::uint8_t mra;
    int source, target;
  };
  for (const Case c :
       {Case{0x00, 0, 0}, Case{kSourceUp, 1, 0}, Case{kSourceDown, -1, 0}, Case{kTargetUp, 0, 1},
        Case{kTargetDown, 0, -1}, Case{kSourceUp | kTargetDown, 1, -1}}) {
    for (const std::uint8_t word : {std::uint8_t{0}, kWord}) {
      Chip chip = irq_chip();
      put(chip, kBlock0, {static_cast<std::uint8_t>(c.mra | word), 0, kFrom + 8, kTo + 8, 9});
      activate(chip);
      const int size = word ? 2 : 1;
      EXPECT_EQ(static_cast<int>(sar(chip, kBlock0) - kFrom - 8), size * c.source);
      EXPECT_EQ(static_cast<int>(dar(chip, kBlock0) - kTo - 8), size * c.target);
      EXPECT_EQ(chip.peek(kTo + 8), 0x48);
      EXPECT_EQ(chip.peek(kTo + 9), word ? 0x49 : 0xa5);
    }
  }
}

// The last transfer: DTCE off, the flag stays, the CPU is interrupted.
TEST(Dtc, EndOfTheCountGoesToTheCpu) {
  Chip chip = irq_chip(true);
  put(chip, kBlock0, {kSourceUp | kTargetUp, 0, kFrom, kTo, 2});
  activate(chip);
  EXPECT_EQ(chip.peek(kDtcera), 0x80);
  request(chip);
  ASSERT_TRUE(run_to(chip, handler(16)));
  EXPECT_EQ(chip.peek(kDtcera), 0x00);
  EXPECT_EQ(cra(chip, kBlock0), 0u);
  EXPECT_EQ(chip.peek16(kTo), 0x4041);
}

TEST(Dtc, CountZeroIs65536) {
  Chip chip = irq_chip();
  put(chip, kBlock0, {kSourceUp | kTargetUp, 0, kFrom, kTo, 0});
  activate(chip);
  EXPECT_EQ(cra(chip, kBlock0), 0xffffu);
  EXPECT_EQ(chip.peek(kDtcera), 0x80);
}

TEST(Dtc, DiselReportsTheCpuEachTime) {
  Chip chip = irq_chip(true);
  put(chip, kBlock0, {kSourceUp | kTargetUp, kAlwaysInterrupt, kFrom, kTo, 9});
  request(chip);
  ASSERT_TRUE(run_to(chip, handler(16)));
  EXPECT_EQ(chip.peek(kDtcera), 0x00);
  EXPECT_EQ(cra(chip, kBlock0), 8u);
}

TEST(Dtc, RepeatModeGoesBackAndNeverEnds) {
  Chip chip = irq_chip(true);
  put(chip, kBlock0, {kSourceUp | kTargetUp | kRepeat | kAreaIsSource, 0, kFrom, kTo, 0x0303});
  for (unsigned k = 0; k < 7; ++k) {
    activate(chip);
    EXPECT_EQ(chip.peek(kTo + k), 0x40 + k % 3) << k;
    EXPECT_EQ(sar(chip, kBlock0), kFrom + (k + 1) % 3);
    EXPECT_EQ(cra(chip, kBlock0), 0x0300u | (3 - (k + 1) % 3));
  }
  EXPECT_EQ(chip.peek(kDtcera), 0x80);
}

// Block mode: K = L = N accesses; the area comes back, the other side goes on.
TEST(Dtc, BlockMode) {
  Chip chip = irq_chip(true);
  put(chip, kBlock0, {kSourceUp | kTargetUp | kBlockMode, 0, kFrom, kTo, 0x0505, 2});
  EXPECT_EQ(activate(chip), 1 + 6 + 5 + 5 + 3);
  EXPECT_EQ(chip.peek32(kTo), 0x40414243u);
  EXPECT_EQ(chip.peek16(kTo + 4), 0x44a5);
  EXPECT_EQ(sar(chip, kBlock0), kFrom + 5);
  EXPECT_EQ(dar(chip, kBlock0), kTo);
  EXPECT_EQ(crb(chip, kBlock0), 1u);
  request(chip);
  ASSERT_TRUE(run_to(chip, handler(16)));
  EXPECT_EQ(chip.peek32(kTo), 0x45464748u);
}

// Information, data and nothing else again for each transfer of a chain.
TEST(Dtc, ChainedTransfers) {
  Chip chip = irq_chip();
  put(chip, kBlock0,
      {kSourceUp | kTargetUp, kChain, kFrom, kTo, 1});  // its end requests no interrupt
  put(chip, kBlock0 + 12, {kSourceUp | kTargetUp | kWord, 0, kFrom + 4, kTo + 4, 5});
  EXPECT_EQ(activate(chip), 1 + 2 * (6 + 2) + 3);
  EXPECT_EQ(chip.peek(kTo), 0x40);
  EXPECT_EQ(chip.peek16(kTo + 4), 0x4445);
  EXPECT_EQ(chip.peek(kDtcera), 0x80);
}

// To a port a byte takes 2 states, to the 16-bit timer bus a word 2, to 8-bit registers 4.
TEST(Dtc, RegistersTakeTheirStates) {
  struct Case {
    std::uint32_t target;
    bool word;
    States data;
  };
  for (const Case c :
       {Case{0xffffac, false, 1 + 2}, Case{0xffff94, true, 1 + 2}, Case{0xffffac, true, 1 + 4}}) {
    Chip chip = irq_chip();
    put(chip, kBlock0, {c.word ? kWord : std::uint8_t{0}, 0, kFrom, c.target, 3});
    EXPECT_EQ(activate(chip), 1 + 6 + c.data + 3);
    EXPECT_EQ(chip.peek(c.target), 0x40);
  }
}

TEST(Dtc, SoftwareActivationAndItsInterrupt) {
  for (const std::uint8_t mrb : {std::uint8_t{0}, kAlwaysInterrupt}) {
    Program p;
    p.modules_on().enable_interrupts().out8(kDtvecr, 0x80 | 0x60).nops(200).stay();
    Chip chip = make_chip(p);
    set_vector(chip, 0x60, kBlock0 + 24);
    ASSERT_TRUE(chip.poke(kFrom, 0x77));
    put(chip, kBlock0 + 24, {0, mrb, kFrom, kTo, 5});
    const bool interrupted = run_to(chip, mrb ? handler(24) : end_of(p) - 2);
    EXPECT_TRUE(interrupted);
    EXPECT_EQ(chip.peek(kTo), 0x77);
    EXPECT_EQ(chip.peek(kDtvecr), mrb ? 0xe0 : 0x60);
  }
}

TEST(Dtc, StoppedModuleIsReported) {
  Chip chip = make_chip(Program().out16(kMstpcr, 0x4000).out8(kDtcera, 0x80).stay());
  chip.run_until(100);
  EXPECT_EQ(chip.peek(kDtcera), 0x00);
  ASSERT_EQ(chip.misuse().size(), 1u);
  EXPECT_EQ(chip.misuse()[0].address, kDtcera);
}

// SCI0 feeds itself from RAM: three bytes; the third is left in TDR for the program to release.
TEST(Dtc, SendsBytesByTxi) {
  Program p;
  p.modules_on().out8(kDtcerc, 0x02).out8(kBrr, 4).out8(kScr, 0xa0).enable_interrupts().stay();
  Options o;
  o.sci_preamble = false;
  Chip chip = make_chip(p, o);
  set_vector(chip, 82, kBlock0);
  for (std::uint8_t k = 0; k < 4; ++k) ASSERT_TRUE(chip.poke(kFrom + k, 0x61 + k));
  put(chip, kBlock0, {kSourceUp, 0, kFrom, kTdr, 3});
  std::vector<std::uint8_t> sent;
  chip.on_transmit([&](int, const TransmittedByte& b) { sent.push_back(b.value); });
  ASSERT_TRUE(run_to(chip, handler(82)));
  chip.run_until(20'000);
  EXPECT_EQ(sent, (std::vector<std::uint8_t>{0x61, 0x62}));
  EXPECT_EQ(chip.peek(kTdr), 0x63);
  EXPECT_EQ(chip.peek(kDtcerc), 0x00);
}

// RXI: RDR into a buffer, RDRF cleared by the reading; the last byte interrupts.
TEST(Dtc, ReceivesBytesByRxi) {
  Program p;
  p.modules_on().out8(kDtcerc, 0x04).out8(kBrr, 4).out8(kScr, 0x50).enable_interrupts();
  p.word(0x0180).stay();
  Chip chip = make_chip(p);
  set_vector(chip, 81, kBlock0);
  put(chip, kBlock0, {kTargetUp, 0, kRdr, kTo, 3});
  for (States k = 0; k < 3; ++k)
    ASSERT_TRUE(
        chip.receive(0, {static_cast<std::uint8_t>(0x31 + k), 2000 + 1600 * k}).has_value());
  chip.run_until(4000);
  EXPECT_TRUE(chip.asleep());  // the CPU sleeps on while data move
  EXPECT_EQ(chip.peek16(kTo), 0x3132);
  EXPECT_EQ(chip.peek(kSsr).value() & 0x40, 0);
  ASSERT_TRUE(run_to(chip, handler(81)));
  EXPECT_EQ(chip.peek(kTo + 2), 0x33);
  EXPECT_EQ(chip.peek(kSsr).value() & 0x40, 0x40);
  EXPECT_GT(chip.now(), 2000 + 3200);
}

// ADI, OCIA and CMIA0: the flag goes, and the next event comes again.
TEST(Dtc, FlagsOfTimersAndConverterGo) {
  Program p;
  p.modules_on().out8(kDtcera, 0x09).out8(0xfffeef, 0x04);
  p.out8(0xffffca, 0x00).out8(0xffffcc, 99).out8(0xffffc8, 0x49);  // TMR0: clear on A, every 800
  p.out16(0xffff94, 0x00ff).out8(0xffff91, 0x01).out8(0xffff90, 0x09);  // FRT: every 512
  p.out8(0xffffe8, 0x78);                                               // A/D: scan, AN0
  p.stay();
  Chip chip = make_chip(p);
  chip.set_analog([](int, States) { return 0.5; });
  set_vector(chip, 28, kBlock0);
  set_vector(chip, 52, kBlock0 + 12);
  set_vector(chip, 64, kBlock0 + 24);
  put(chip, kBlock0, {kTargetUp | kWord, 0, 0xffffe0, kTo, 100});
  put(chip, kBlock0 + 12, {kTargetUp, 0, kFrom, kTo + 0x100, 100});
  put(chip, kBlock0 + 24, {kTargetUp, 0, kFrom, kTo + 0x200, 100});
  chip.run_until(8100);
  EXPECT_NEAR(100 - cra(chip, kBlock0), 8000 / 128, 1);
  EXPECT_NEAR(100 - cra(chip, kBlock0 + 12), 8000 / 512, 1);
  EXPECT_NEAR(100 - cra(chip, kBlock0 + 24), 8000 / 800, 1);
  EXPECT_EQ(chip.peek16(kTo), 0x8000);
  EXPECT_EQ(chip.peek(0xffffe8).value() & 0x80, 0);
}

TEST(Dtc, InformationOutsideItsAreaIsReported) {
  Chip chip = irq_chip(true);
  set_vector(chip, 16, 0xe100);
  request(chip);
  ASSERT_TRUE(run_to(chip, handler(16)));
  ASSERT_EQ(chip.misuse().size(), 1u);
  EXPECT_NE(chip.misuse()[0].text.find("FFEC00"), std::string::npos);
}

}  // namespace
}  // namespace kaz::h8s::testing
