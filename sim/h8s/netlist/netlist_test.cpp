// Netlists: wires, pulls, gates and low-passes around a chip, and the text form.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/netlist/netlist.h"

#include <cmath>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/netlist/parts.h"

namespace kaz::h8s::testing {
namespace {

// TMO0 toggles every 40 states.
Program toggling() {
  Program p;
  p.modules_on().out8(0xffffcc, 4).out8(0xffffca, 0x03).out8(0xffffc8, 0x09);
  return p;
}

TEST(Netlist, PullsDefineAnInputAndThePortGoesOver) {
  Chip chip = make_chip(Program().nops(50).out8(0xffffb4, 1).stay());
  Netlist board(chip);
  board.pull_up(board.net("P30"), 10'000);
  board.pull_down(board.net("P31"), 10'000);
  EXPECT_TRUE(chip.level(Pin::p30));
  EXPECT_EQ(chip.state(Pin::p30).driver, Driver::board);
  EXPECT_FALSE(chip.level(Pin::p31));
  EXPECT_EQ(board.voltage(board.net("P32"), 0), std::nullopt);
  chip.run_until(100);  // DDR bit 0: the latch is low
  EXPECT_FALSE(chip.level(Pin::p30));
  EXPECT_FALSE(board.level(board.net("P30")));
  EXPECT_TRUE(board.conflicts().empty());
  chip.reset();
  EXPECT_TRUE(chip.level(Pin::p30)) << "an input again";
}

// The chip's pull-up of 50 kOhm against 10 kOhm to ground: a sixth of the supply.
TEST(Netlist, ResistorsShareAPin) {
  Chip chip = make_chip(Program().out8(0xffffae, 1).stay());
  Netlist board(chip);
  const Net net = board.net("P30");
  board.pull_down(net, 10'000);
  chip.run_until(50);
  EXPECT_NEAR(board.voltage(net, 50).value(), 1.0 / 6, 1e-12);
  EXPECT_FALSE(chip.level(Pin::p30));
  board.pull_up(net, 1'000);
  EXPECT_TRUE(chip.level(Pin::p30));
}

TEST(Netlist, AWireCarriesEachEdgeAtItsState) {
  Program p = toggling();
  p.out8(0xffff96, 3).out16(0xffff92, 0).stay();  // FRC counts rising edges of FTCI
  Chip chip = make_chip(p);
  Netlist board(chip);
  board.wire(board.net("TMO0"), board.net("FTCI"));
  std::vector<States> out, in;
  chip.watch(Pin::p64, [&](const PinEdge& e) { out.push_back(e.at); });
  chip.watch(Pin::p60, [&](const PinEdge& e) { in.push_back(e.at); });
  chip.run_until(60);
  const std::uint16_t before = chip.peek16(0xffff92).value();
  chip.run_until(60 + 8000);
  EXPECT_EQ(chip.peek16(0xffff92), before + 100);
  EXPECT_EQ(out, in);
  EXPECT_GT(out.size(), 195u);
  EXPECT_TRUE(board.conflicts().empty());
}

// The guest sends H'A5 on SCI1 and takes it in again: P25 wired to P26.
TEST(Netlist, ALoopbackWireBringsTheByteBack) {
  Program p;
  p.modules_on().out8(0xffff89, 4).out8(0xffff8a, 0x30).out8(0xffff8b, 0xa5);
  p.in8(0xffff8c).out8(0xffff8c, 0x04).stay();
  Chip chip = make_chip(p), open = make_chip(p);
  Netlist board(chip);
  board.wire(board.net("TxD1"), board.net("RxD1"));
  for (Chip* c : {&chip, &open}) c->run_until(6000);
  EXPECT_EQ(chip.peek(0xffff8d), 0xa5);
  EXPECT_EQ(chip.peek(0xffff8c).value() & 0x78, 0x40) << "RDRF and no error";
  EXPECT_EQ(open.peek(0xffff8c).value() & 0x40, 0);
}

TEST(Netlist, ConflictsNameBothDriversAndTheState) {
  Chip chip = make_chip(Program().out8(0xffffb6, 0x01).out8(0xffffb4, 0x03).stay());
  Netlist board(chip);
  board.wire(board.net("P30"), board.net("P31"));
  chip.run_until(100);
  ASSERT_EQ(board.conflicts().size(), 1u);
  EXPECT_EQ(board.conflicts()[0].text(),
            "net P30/P31 is driven both high and low from state 10 on: by P30 (port) and by P31 "
            "(port)");
}

TEST(Netlist, SwitchesAndGatesReact) {
  Chip chip = make_chip(Program().stay());
  Netlist board(chip);
  const Net button = board.net("P40"), out = board.net("P41"), drain = board.net("bus");
  board.pull_up(button, 10'000);
  board.pull_up(drain, 10'000);
  Switch& s = board.add(std::make_unique<Switch>(button, false));
  board.add(std::make_unique<Inverter>(button, out, 7));
  board.add(std::make_unique<OpenDrain>(out, drain));
  Probe& probe = board.add(std::make_unique<Probe>(drain, "bus"));
  EXPECT_TRUE(chip.level(Pin::p40));
  EXPECT_FALSE(chip.level(Pin::p41));
  s.set_at(board, 1000, true);
  s.set_at(board, 1500, false);
  chip.run_until(3000);
  EXPECT_EQ(probe.levels(),
            (std::vector<std::pair<States, bool>>{{0, true}, {1007, false}, {1507, true}}));
  EXPECT_DOUBLE_EQ(probe.high_share(0, 2000), 0.75);
  s.set(board, true);
  EXPECT_FALSE(chip.level(Pin::p40)) << "at once";
}

TEST(Netlist, ALoopWithoutDelayIsReportedAndEnds) {
  Chip chip = make_chip(Program().stay());
  Netlist board(chip);
  const Net a = board.net("a");
  board.add(std::make_unique<Inverter>(a, a));
  chip.run_until(100);
  ASSERT_FALSE(board.conflicts().empty());
  EXPECT_NE(board.conflicts()[0].text().find("does not settle"), std::string::npos);
}

TEST(Netlist, ARingWithDelayOscillatesAtItsPeriod) {
  Chip chip = make_chip(Program().stay());
  Netlist board(chip);
  const Net a = board.net("a");
  board.add(std::make_unique<Inverter>(a, board.net("b"), 5));
  board.wire(a, board.net("b"));
  Probe& probe = board.add(std::make_unique<Probe>(a, "a"));
  chip.run_until(1000);
  ASSERT_GT(probe.levels().size(), 190u);
  for (std::size_t k = 3; k < probe.levels().size(); ++k)
    EXPECT_EQ(probe.levels()[k].first - probe.levels()[k - 1].first, 5);
}

// TMO0 over 1 kOhm and 1 nF to AN0; between edges v = vin + (v0 - vin) exp(-t / RC).
TEST(Netlist, ALowPassFollowsTheClosedFormula) {
  Chip chip = make_chip(toggling().stay());
  Netlist board(chip);
  board.wire(board.net("TMO0"), board.net("pwm"));
  board.add(std::make_unique<Rc>(board.net("pwm"), board.net("AN0"), 1e3, 1e-9));
  double v = 0, in = 0;
  States last = 0;
  bool driven = false;
  const double tau = 1e3 * 1e-9 * 18'432'000;
  const auto to = [&](States at) {
    if (driven) v = in + (v - in) * std::exp(-static_cast<double>(at - last) / tau);
    last = at;
  };
  chip.watch(
      Pin::p64,
      [&](const PinEdge& e) {
        to(e.at);
        driven = e.driver == Driver::tmr;
        in = e.level ? 1 : 0;
      },
      true);
  for (States at = 100; at < 3000; at += 37) {
    chip.run_until(at);
    to(chip.now());
    EXPECT_NEAR(board.voltage(board.net("AN0"), chip.now()).value(), v, 1e-9);
  }
  // Half the time high, 40 states each: the peaks of the settled wave.
  const double e = std::exp(-40 / tau);
  EXPECT_GT(v, e / (1 + e) - 0.01);
  EXPECT_LT(v, 1 / (1 + e) + 0.01);
}

TEST(Netlist, TheConverterSamplesTheNets) {
  Program p;
  p.modules_on().out8(0xffffe8, 0x29).stay();  // single conversion of AN1, fast
  Chip chip = make_chip(p);
  Netlist board(chip);
  ASSERT_TRUE(read_netlist(board, "analog half 0.5\ndivider half AN1 10k 10k\n", "x").has_value());
  chip.run_until(1000);
  EXPECT_EQ(chip.peek16(0xffffe2), 256 << 6);
}

// A digital input at the low-pass goes high as it passes half the supply: RC ln 2 after the edge.
TEST(Netlist, ALowPassCrossesTheThresholdOfAnInput) {
  Chip chip = make_chip(Program().stay());
  Netlist board(chip);
  ASSERT_TRUE(
      read_netlist(board, "switch s vcc 1000..20000\npull-down s 1k\nrc s P42 10k 10n\n", "x")
          .has_value());
  std::vector<States> edges;
  chip.watch(Pin::p42, [&](const PinEdge& e) { edges.push_back(e.at); });
  chip.run_until(40'000);
  const double tau = 10e3 * 10e-9 * 18'432'000;
  ASSERT_EQ(edges.size(), 2u);
  EXPECT_EQ(edges[0], 1000 + static_cast<States>(std::ceil(tau * std::log(2.0))));
  EXPECT_NEAR(static_cast<double>(edges[1]), 20'000 + tau * std::log(2.0), 2);
}

TEST(Netlist, SaveAndRestoreGoOnTheSame) {
  Program p = toggling();
  p.stay();
  Chip chip = make_chip(p);
  Netlist board(chip);
  ASSERT_TRUE(read_netlist(board,
                           "rc TMO0 AN0 10k 10n\ninverter TMO0 P30 13\nswitch P31 vcc 700..1700\n",
                           "x")
                  .has_value());
  std::vector<PinEdge> edges;
  for (const Pin pin : {Pin::p30, Pin::p31})
    chip.watch(pin, [&](const PinEdge& e) { edges.push_back(e); });
  chip.run_until(1000);
  const auto saved = chip.save();
  const auto parts = board.save();
  const auto run = [&] {
    edges.clear();
    chip.run_until(2500);
    std::vector<std::pair<States, bool>> reported;
    for (const PinEdge& e : edges) reported.emplace_back(e.at, e.level);
    return std::make_pair(reported, board.voltage(board.net("AN0"), chip.now()).value());
  };
  const auto once = run();
  chip.restore(*saved);
  board.restore(parts);
  EXPECT_EQ(run(), once);
  EXPECT_GT(once.first.size(), 30u);
}

TEST(Netlist, TextErrorsNameThePlaceAndWhatIsExpected) {
  Chip chip = make_chip(Program().stay());
  Netlist board(chip);
  const auto message = [&](const std::string& text) {
    const auto r = read_netlist(board, text, "board.net");
    return r ? std::string("none") : r.error().message;
  };
  EXPECT_EQ(message("# nothing\n\npull-up P40 10k  # fine\nwire TxD1 RxD1 P30\n"), "none");
  EXPECT_EQ(message("pull-up P40"),
            "board.net:1:12: expected ohms such as 10k, found the end of the line");
  EXPECT_EQ(message("\n  pull-up P53 10k"),
            "board.net:2:11: expected a pin (P40, TxD1), vcc, gnd or the name of a net, found "
            "'P53'");
  EXPECT_EQ(message("resistor P40 10k"),
            "board.net:1:1: expected pull-up, pull-down, wire, analog, switch, inverter, "
            "open-drain, rc, divider or probe, found 'resistor'");
  EXPECT_EQ(message("rc PW0 AN0 10k 1q"),
            "board.net:1:16: expected farads such as 100n, found '1q'");
  EXPECT_EQ(message("analog AN1 1.5"),
            "board.net:1:12: expected a share of AVCC from 0 to 1, found '1.5'");
  EXPECT_EQ(message("switch P42 gnd 5ms..2ms"),
            "board.net:1:16: expected times such as 1ms..2ms, in ascending order, found "
            "'5ms..2ms'");
  for (const std::string ohms : {"nan", "inf", "-1", "1e999", "1e308M", "0x1p3"})
    EXPECT_EQ(message("pull-up P40 " + ohms),
              "board.net:1:13: expected ohms such as 10k, found '" + ohms + "'");
  EXPECT_EQ(message("probe led1 x"), "board.net:1:12: expected the end of the line, found 'x'");
  const auto nowhere = load_netlist(board, "/nonexistent/board.net");
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_NE(nowhere.error().message.find("/nonexistent/board.net"), std::string::npos);
}

}  // namespace
}  // namespace kaz::h8s::testing
