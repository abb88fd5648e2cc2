// Pins: the table of names, and every edge with its exact state.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>

#include "sim/h8s/chip/chip_testing.h"

namespace kaz::h8s::testing {
namespace {

constexpr std::uint32_t kP3ddr = 0xffffb4, kP3dr = 0xffffb6, kP1ddr = 0xffffb0, kP1pcr = 0xffffac;

struct Recorder {
  std::vector<PinEdge> edges;
  void watch(Chip& chip, Pin pin) {
    chip.watch(pin, [this](const PinEdge& e) { edges.push_back(e); });
  }
  std::vector<States> times() const {
    std::vector<States> at;
    for (const PinEdge& e : edges) at.push_back(e.at);
    return at;
  }
};

std::string lower(std::string_view s) {
  std::string out(s);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

// Two channels of PWM at phi/2 and phi, TMO0 toggling, FTOA following matches, SCI0 sending.
Program noisy_program() {
  Program p;
  p.modules_on().out8(kP1ddr, 0xff).out8(0xffffd3, 0x09);
  p.out8(0xffffd6, 0x20).out8(0xffffd7, 0x81).out8(0xffffd6, 0x23).out8(0xffffd7, 0x37);
  p.out8(0xffffd6, 0xe3);                                         // phi/2
  p.out8(0xffffcc, 4).out8(0xffffca, 0x03).out8(0xffffc8, 0x09);  // TMR0: phi/8, clear on A
  p.out16(0xffff94, 49).out8(0xffff91, 1).out8(0xffff97, 0x0a);   // FRT: phi/2, FTOA high
  p.out8(0xffff90, 0x09);                                         // OCIAE
  p.out8(0xffffd9, 0).out8(0xffffda, 0x20).out8(0xffffdb, 0x53).in8(0xffffdc).out8(0xffffdc, 4);
  return p.enable_interrupts();
}

Program looping(Program p) {
  const std::uint32_t loop = end_of(p);
  p.in8(0xffffd0).in8(0xffff93).out8(kP3ddr, 1).out8(kP3dr, 1).out8(kP3dr, 0).in8(kP3dr);
  p.word(static_cast<std::uint16_t>(0x4000 | ((loop - end_of(p) - 2) & 0xff)));
  return p;
}

Chip noisy_chip() {
  Chip chip = make_chip(looping(noisy_program()));
  // Handler of OCIA: toggles OLVLA, clears OCFA: bnot #1,@TOCR ; bclr #3,@TCSR ; rte.
  chip.poke(handler(52),
            std::vector<std::uint8_t>{0x7f, 0x97, 0x71, 0x10, 0x7f, 0x91, 0x72, 0x30, 0x56, 0x70});
  return chip;
}

TEST(PinTable, HoldsThePartsPins) {
  int io = 0, inputs = 0;
  std::map<int, int> width;
  std::set<std::string> names;
  for (std::size_t k = 0; k < pin_table().size(); ++k) {
    const PinInfo& p = pin_table()[k];
    EXPECT_EQ(static_cast<std::size_t>(p.pin), k);
    if (p.port > 0) {
      (p.input_only ? inputs : io)++;
      ++width[p.port];
      EXPECT_EQ(p.name(), std::string({'P', static_cast<char>('0' + p.port),
                                       static_cast<char>('0' + p.bit)}));
      EXPECT_EQ(pin_of(p.port, p.bit), p.pin);
    }
    for (const std::string_view n : p.names) {
      EXPECT_TRUE(names.insert(lower(n)).second) << n << " stands twice";
      EXPECT_EQ(find_pin(n), p.pin);
      EXPECT_EQ(find_pin(lower(n)), p.pin);
    }
  }
  EXPECT_EQ(io, 43);
  EXPECT_EQ(inputs, 8);
  EXPECT_EQ(width, (std::map<int, int>{{1, 8}, {2, 8}, {3, 8}, {4, 8}, {5, 3}, {6, 8}, {7, 8}}));
  EXPECT_EQ(find_pin("TxD0"), Pin::p50);
  EXPECT_EQ(find_pin("PW13"), Pin::p25);
  EXPECT_EQ(find_pin("TMO1"), Pin::p67);
  EXPECT_EQ(find_pin("IRQ0"), Pin::p42);
  EXPECT_EQ(find_pin("AN7"), Pin::p77);
  EXPECT_EQ(find_pin("P53"), std::nullopt);
  EXPECT_EQ(pin_of(5, 3), std::nullopt);
  for (const char* n : {"PW0", "PW15", "AN0", "CIN0", "CIN7", "FTIA", "FTOB", "NMI", "RES", "STBY"})
    EXPECT_TRUE(find_pin(n).has_value()) << n;
}

TEST(Pins, SayWhoDrives) {
  Chip chip = make_chip(Program().out8(kP1pcr, 0x01).out8(kP1ddr, 0x02).stay());
  EXPECT_EQ(chip.state(Pin::p10), (PinState{false, Driver::nobody, false}));
  run_to(chip, kCode + 12);
  EXPECT_EQ(chip.state(Pin::p10), (PinState{true, Driver::pull_up, true}));
  EXPECT_EQ(chip.state(Pin::p11), (PinState{false, Driver::port, false}));
  chip.set_input(Pin::p10, false);
  EXPECT_EQ(chip.state(Pin::p10), (PinState{false, Driver::board, true}));
  chip.release_input(Pin::p10);
  EXPECT_EQ(chip.state(Pin::p10).driver, Driver::pull_up);
  chip.set_input(Pin::nmi, false);
  EXPECT_FALSE(chip.level(Pin::nmi));
  EXPECT_TRUE(chip.level(Pin::md1));
  EXPECT_FALSE(chip.level(Pin::md0));
}

// mov.b #,r0l takes 1 state, mov.b r0l,@aa:16 3 and one more for the register; the level changes
// at its end.
TEST(PinEdges, OfAPortStandAtTheEndOfTheWrite) {
  Chip chip =
      make_chip(Program().out8(kP3ddr, 1).out8(kP3dr, 1).out8(kP3dr, 1).out8(kP3dr, 0).stay());
  Recorder r;
  r.watch(chip, Pin::p30);
  const States start = chip.now();
  chip.run_until(100);
  ASSERT_EQ(r.edges.size(), 2u);
  EXPECT_EQ(r.edges[0].at, start + 10);
  EXPECT_TRUE(r.edges[0].level);
  EXPECT_EQ(r.edges[0].driver, Driver::port);
  EXPECT_EQ(r.edges[1].at, start + 20);
  EXPECT_FALSE(r.edges[1].level);
}

// PWDR = H'37: every basic pulse 3 counts high, those with odd numbers from 3 on one more (hardware
// manual, table of added pulses); a count is 2 states, a basic pulse 16 counts.
TEST(PinEdges, OfPwmFollowThePulseDivision) {
  Chip chip = noisy_chip();
  chip.run_until(2000);
  Recorder r;
  r.watch(chip, Pin::p13);
  chip.run_until(2000 + 40 * 32);
  ASSERT_GE(r.edges.size(), 76u);
  if (!r.edges.front().level) r.edges.erase(r.edges.begin());
  std::vector<States> widths;
  for (std::size_t k = 0; k + 2 < r.edges.size(); k += 2) {
    ASSERT_TRUE(r.edges[k].level);
    ASSERT_FALSE(r.edges[k + 1].level);
    widths.push_back(r.edges[k + 1].at - r.edges[k].at);
    if (k + 3 < r.edges.size()) {
      EXPECT_EQ(r.edges[k + 3].at - r.edges[k + 1].at, 32);
    }
  }
  std::vector<States> expected;
  for (int pulse = 0; pulse < 16; ++pulse)
    expected.push_back(2 * (pulse >= 3 && pulse % 2 == 1 ? 4 : 3));
  const auto first =
      std::search(widths.begin(), widths.begin() + 32, expected.begin(), expected.end());
  ASSERT_LT(first - widths.begin(), 16);
  for (auto k = first; k < widths.end(); ++k)
    EXPECT_EQ(*k, expected[static_cast<std::size_t>(k - first) % 16]);
}

// H'53 at 32 states a bit: start, 1 1 0 0 1 0 1 0, stop.
TEST(PinEdges, OfTxdAreTheBitsOfTheByte) {
  Chip chip = noisy_chip();
  Recorder r;
  r.watch(chip, *find_pin("TxD0"));
  States start = 0;
  chip.on_transmit([&](int, const TransmittedByte& b) { start = b.start; });
  chip.run_until(3000);
  ASSERT_GT(start, 0);
  std::erase_if(r.edges, [&](const PinEdge& e) { return e.at < start; });  // the port, the preamble
  const std::vector<States> expected{start,       start + 32,  start + 96,  start + 160,
                                     start + 192, start + 224, start + 256, start + 288};
  EXPECT_EQ(r.times(), expected);
  for (std::size_t k = 0; k < r.edges.size(); ++k) {
    EXPECT_EQ(r.edges[k].level, k % 2 == 1);
    EXPECT_EQ(r.edges[k].driver, Driver::sci);
  }
}

// TCORA = 4 at phi/8 with clear and toggle: a turn is 5 counts. The loop reads TCNT and the handler
// of OCIA runs every 100 states all the while.
TEST(PinEdges, OfTmoToggleOnTheStateUnderInterrupts) {
  Chip chip = noisy_chip();
  chip.run_until(1000);
  Recorder r;
  r.watch(chip, *find_pin("TMO0"));
  chip.run_until(9000);
  ASSERT_EQ(r.edges.size(), 200u);
  for (std::size_t k = 1; k < r.edges.size(); ++k) {
    EXPECT_EQ(r.edges[k].at - r.edges[k - 1].at, 40);
    EXPECT_NE(r.edges[k].level, r.edges[k - 1].level);
  }
}

TEST(PinEdges, OfFtoaStandAtTheMatch) {
  Chip chip = noisy_chip();
  chip.run_until(1000);
  Recorder r;
  r.watch(chip, *find_pin("FTOA"));
  chip.run_until(5000);
  ASSERT_EQ(r.edges.size(), 40u);
  for (std::size_t k = 1; k < r.edges.size(); ++k)
    EXPECT_EQ(r.edges[k].at - r.edges[k - 1].at, 100);
}

TEST(PinEdges, ComeInTheOrderOfStates) {
  Chip chip = noisy_chip();
  Recorder r;
  for (const PinInfo& p : pin_table()) r.watch(chip, p.pin);
  chip.run_until(20'000);
  EXPECT_GT(r.edges.size(), 3000u);
  EXPECT_TRUE(std::is_sorted(r.edges.begin(), r.edges.end(),
                             [](const PinEdge& a, const PinEdge& b) { return a.at < b.at; }));
  std::map<Pin, bool> level;
  for (const PinEdge& e : r.edges) {
    if (level.contains(e.pin)) {
      EXPECT_NE(level[e.pin], e.level);
    }
    level[e.pin] = e.level;
  }
}

TEST(PinEdges, WatchingChangesNothingElse) {
  Chip plain = noisy_chip(), watched = noisy_chip();
  Recorder r;
  for (const PinInfo& p : pin_table()) r.watch(watched, p.pin);
  for (States at = 500; at <= 30'000; at += 500) {
    plain.run_until(at);
    watched.run_until(at);
    ASSERT_EQ(plain.now(), watched.now());
    ASSERT_EQ(plain.registers(), watched.registers());
  }
  for (std::uint32_t at = 0xffe080; at < 0x1000000; ++at)
    ASSERT_EQ(plain.peek(at), watched.peek(at)) << std::hex << at;
}

TEST(PinEdges, GoOnAfterSaveAndRestoreAndHoweverTheTimeIsCut) {
  Chip chip = noisy_chip();
  Recorder whole;
  for (const Pin p : {Pin::p10, Pin::p13, Pin::p50, Pin::p61, Pin::p64}) whole.watch(chip, p);
  chip.run_until(1777);
  const auto saved = chip.save();
  whole.edges.clear();
  chip.run_until(9000);

  Chip other;
  Recorder rest;
  for (const Pin p : {Pin::p10, Pin::p13, Pin::p50, Pin::p61, Pin::p64}) rest.watch(other, p);
  other.restore(*saved);
  for (States at = 1780; at <= 9000; at += 7) other.run_until(at);
  other.run_until(9000);
  const auto same = [](const PinEdge& a, const PinEdge& b) {
    return a.pin == b.pin && a.level == b.level && a.at == b.at;
  };
  EXPECT_TRUE(std::equal(whole.edges.begin(), whole.edges.end(), rest.edges.begin(),
                         rest.edges.end(), same));
  EXPECT_GT(rest.edges.size(), 500u);
}

// The listener closes a wire from TMO0 to FTCI: FRC counts its rising edges, one in 80 states.
TEST(PinEdges, AReactionActsAtTheEdgesState) {
  Program p;
  p.modules_on().out8(0xffff96, 3).out16(0xffff92, 0);  // FRT: rising FTCI
  p.out8(0xffffcc, 4).out8(0xffffca, 0x03).out8(0xffffc8, 0x09).stay();
  Chip chip = make_chip(p);
  std::vector<States> rising;
  chip.watch(*find_pin("TMO0"), [&](const PinEdge& e) {
    chip.set_input(*find_pin("FTCI"), e.level);
    if (e.level) rising.push_back(e.at);
    EXPECT_EQ(chip.peek16(0xffff92), rising.size()) << "counted at once";
  });
  std::vector<States> echo;
  chip.watch(*find_pin("FTCI"), [&](const PinEdge& e) {
    if (e.level) echo.push_back(e.at);
  });
  chip.run_until(4000);
  EXPECT_GT(rising.size(), 45u);
  EXPECT_EQ(echo, rising);
  EXPECT_EQ(chip.peek16(0xffff92), rising.size());
}

TEST(PinCalls, ComeAtTheirStateAlsoWhileAsleep) {
  Chip chip = make_chip(Program().out8(0xffffc2, 0x01).enable_interrupts().word(0x0180).stay());
  std::vector<States> called;
  chip.call_at(500, [&](States at) {
    called.push_back(at);
    chip.set_input(*find_pin("IRQ0"), false);
  });
  const int dropped = chip.call_at(600, [&](States at) { called.push_back(at); });
  chip.call_at(400, [&, dropped](States at) {
    called.push_back(at);
    chip.cancel(dropped);
  });
  chip.run_until(700);
  EXPECT_EQ(called, (std::vector<States>{400, 500}));
  EXPECT_FALSE(chip.asleep());
}

TEST(PinCalls, UnwatchedPinsAreSilent) {
  Chip chip = noisy_chip();
  int edges = 0;
  const int id = chip.watch(Pin::p64, [&](const PinEdge&) { ++edges; });
  chip.run_until(2000);
  EXPECT_GT(edges, 10);
  chip.unwatch(id);
  const int before = edges;
  chip.run_until(4000);
  EXPECT_EQ(edges, before);
}

}  // namespace
}  // namespace kaz::h8s::testing
