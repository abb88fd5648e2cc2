// VCD files, read by a small independent parser.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/vcd.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "sim/h8s/chip/chip_testing.h"
#include "sim/h8s/chip/registers.h"

namespace kaz::h8s::testing {
namespace {

struct Change {
  std::int64_t at;
  std::string value;
  bool operator==(const Change&) const = default;
};

struct Parsed {
  std::string timescale;
  std::map<std::string, std::string> path;  // by code
  std::map<std::string, int> bits;          // by path
  std::map<std::string, std::vector<Change>> changes;
  std::int64_t end = 0;
};

Parsed parse(const std::string& text) {
  std::istringstream in(text);
  Parsed p;
  std::vector<std::string> scopes;
  std::string token;
  const auto upto_end = [&] {
    std::vector<std::string> words;
    while (in >> token && token != "$end") words.push_back(token);
    EXPECT_EQ(token, "$end");
    return words;
  };
  bool header = true;
  while (header && in >> token) {
    const std::string keyword = token;
    const auto words = upto_end();
    if (keyword == "$timescale") p.timescale = words.at(0) + words.at(1);
    if (keyword == "$scope") scopes.push_back(words.at(1));
    if (keyword == "$upscope") scopes.pop_back();
    if (keyword == "$var") {
      std::string path;
      for (const std::string& s : scopes) path += s + ".";
      path += words.at(3);
      EXPECT_TRUE(p.path.emplace(words.at(2), path).second);
      p.bits[path] = std::stoi(words.at(1));
    }
    header = keyword != "$enddefinitions";
  }
  EXPECT_TRUE(scopes.empty());
  std::int64_t last = -1;
  const auto put = [&](const std::string& code, const std::string& value) {
    ASSERT_TRUE(p.path.contains(code)) << code;
    EXPECT_EQ(static_cast<int>(value.size()), p.bits[p.path[code]]);
    p.changes[p.path[code]].push_back({p.end, value});
  };
  while (in >> token) {
    if (token == "$dumpvars" || token == "$end") continue;
    if (token[0] == '#') {
      p.end = std::stoll(token.substr(1));
      EXPECT_GT(p.end, last);
      last = p.end;
    } else if (token[0] == 'b') {
      std::string code;
      in >> code;
      put(code, token.substr(1));
    } else {
      put(token.substr(1), token.substr(0, 1));
    }
  }
  return p;
}

// P30 goes up at state 20 and down at 30, ER0 counts up; TMO0 toggles every 40 states.
Program program() {
  Program p;
  p.modules_on().out8(0xffffb4, 1).out8(0xffffb6, 1).out8(0xffffb6, 0);
  p.out8(0xffffcc, 4).out8(0xffffca, 0x03).out8(0xffffc8, 0x09);
  return p.word(0x0b70).word(0x40fc);  // inc.l #1,er0 ; bra .-2
}

// At 20 MHz a state is 50,000 ps.
constexpr std::int64_t kHertz = 20'000'000, kState = 50'000;

std::string record(Chip& chip, const std::vector<std::string>& names, States until) {
  std::ostringstream out;
  auto recorder = VcdRecorder::open(chip, names, out, kHertz);
  EXPECT_TRUE(recorder.has_value()) << (recorder ? "" : recorder.error().message);
  chip.run_until(until);
  EXPECT_TRUE((*recorder)->close().has_value());
  return out.str();
}

TEST(Vcd, PinsHaveTheirExactStates) {
  Chip chip = make_chip(program());
  std::vector<PinEdge> edges;
  for (const Pin p : {Pin::p30, Pin::p64})
    chip.watch(p, [&](const PinEdge& e) { edges.push_back(e); });
  const Parsed p = parse(record(chip, {"P30", "TMO0", "P40"}, 1000));
  EXPECT_EQ(p.timescale, "1ps");
  ASSERT_TRUE(p.changes.contains("h8s2128.pins.P30"));
  for (const Pin pin : {Pin::p30, Pin::p64}) {
    std::vector<Change> reported;
    for (const PinEdge& e : edges) {
      if (e.pin == pin) reported.push_back({e.at * kState, e.level ? "1" : "0"});
    }
    ASSERT_GE(reported.size(), 2u);
    auto written = p.changes.at(pin == Pin::p30 ? "h8s2128.pins.P30" : "h8s2128.pins.P64_FTIC");
    ASSERT_GE(written.size(), 2u);
    EXPECT_EQ(written[0], (Change{0, "z"}));
    EXPECT_EQ(written[1].value, "0");  // becomes an output
    written.erase(written.begin(), written.begin() + 2);
    EXPECT_EQ(written, reported);
  }
  EXPECT_EQ(p.changes.at("h8s2128.pins.P40_IRQ2"), (std::vector<Change>{{0, "z"}}));
  EXPECT_EQ(p.end, chip.now() * kState);
}

TEST(Vcd, RegistersChangeAtInstructionBoundaries) {
  Chip chip = make_chip(program()), twin = make_chip(program());
  const Parsed p = parse(record(chip, {"er0", "pc", "TCNT0", "0xffe100:16", "MSTPCRL"}, 600));
  std::vector<Change> er0, tcnt;
  const auto note = [](std::vector<Change>& to, States at, std::uint32_t value, int bits) {
    std::string text;
    for (int k = bits - 1; k >= 0; --k) text += value >> k & 1 ? '1' : '0';
    if (to.empty() || to.back().value != text) to.push_back({at * kState, text});
  };
  while (twin.now() < chip.now()) {
    note(er0, twin.now(), twin.registers().er[0], 32);
    note(tcnt, twin.now(), twin.peek(0xffffd0).value(), 8);
    twin.step();
  }
  note(er0, twin.now(), twin.registers().er[0], 32);
  note(tcnt, twin.now(), twin.peek(0xffffd0).value(), 8);
  EXPECT_EQ(p.changes.at("h8s2128.cpu.er0"), er0);
  EXPECT_EQ(p.changes.at("h8s2128.TMR0.TCNT0"), tcnt);
  EXPECT_EQ(p.changes.at("h8s2128.memory.0xffe100").size(), 1u);
  EXPECT_EQ(p.changes.at("h8s2128.SYSTEM.MSTPCRL").back().value, "00000000");
}

TEST(Vcd, TimesAreRoundedToThePicosecond) {
  EXPECT_EQ(picoseconds(1, 18'432'000), 54'253);   // 54253.47
  EXPECT_EQ(picoseconds(2, 18'432'000), 108'507);  // 108506.94
  EXPECT_EQ(picoseconds(18'432'000LL * 3600, 18'432'000), 3'600'000'000'000'000);
}

TEST(Vcd, RecordingChangesNothing) {
  Chip plain = make_chip(program()), recorded = make_chip(program());
  record(recorded, {"pins", "cpu", "FRC", "TCNT0"}, 5000);
  plain.run_until(5000);
  EXPECT_EQ(plain.now(), recorded.now());
  EXPECT_EQ(plain.registers(), recorded.registers());
}

TEST(Vcd, GoesOnAfterRestoreWhereNewTimeBegins) {
  Chip straight = make_chip(program()), back = make_chip(program());
  const std::string once = record(straight, {"P30", "TMO0", "er0"}, 900);
  std::ostringstream out;
  auto recorder = VcdRecorder::open(back, {"P30", "TMO0", "er0"}, out, kHertz);
  ASSERT_TRUE(recorder.has_value());
  back.run_until(300);
  const auto saved = back.save();
  back.run_until(500);
  back.restore(*saved);
  back.run_until(900);
  ASSERT_TRUE((*recorder)->close().has_value());
  EXPECT_EQ(out.str(), once);
}

TEST(Vcd, NamesThatAreNothingAreErrors) {
  Chip chip = make_chip(program());
  std::ostringstream out;
  const auto message = [&](const std::string& name) {
    const auto r = VcdRecorder::open(chip, {name}, out);
    return r ? std::string() : r.error().message;
  };
  EXPECT_NE(message("P53").find("'P53': must be a pin"), std::string::npos);
  EXPECT_NE(message("P3DDR").find("write-only"), std::string::npos);
  EXPECT_NE(message("0xffe100:12").find("8, 16 or 32"), std::string::npos);
  EXPECT_NE(message("0x400000").find("no memory or register"), std::string::npos);
  EXPECT_NE(message("0xzz").find("not a 24-bit address"), std::string::npos);
}

TEST(Vcd, FilesAppearWhenTheyAreComplete) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / "kaz_h8s_vcd_test";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const std::string path = (folder / "a.vcd").string();
  Chip chip = make_chip(program());
  {
    auto recorder = VcdRecorder::open(chip, {"P30"}, path);
    ASSERT_TRUE(recorder.has_value());
    chip.run_until(100);
    EXPECT_FALSE(fs::exists(path));
    ASSERT_TRUE((*recorder)->close().has_value());
    EXPECT_TRUE(fs::exists(path));
  }
  {
    auto recorder = VcdRecorder::open(chip, {"P30"}, (folder / "b.vcd").string());
    ASSERT_TRUE(recorder.has_value());
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
  const auto nowhere = VcdRecorder::open(chip, {"P30"}, (folder / "no" / "c.vcd").string());
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_NE(nowhere.error().message.find("cannot write"), std::string::npos);
  fs::remove_all(folder);
}

TEST(Vcd, AFullDiskIsAnError) {
  std::ofstream full("/dev/full");
  if (!full) return;  // a system without it has nothing to show
  Chip chip = make_chip(program());
  auto recorder = VcdRecorder::open(chip, {"P30"}, full);
  ASSERT_TRUE(recorder.has_value());
  chip.run_until(100);
  EXPECT_FALSE((*recorder)->close().has_value());
}

TEST(RegisterTable, NamesAreUniqueAndBanksExclude) {
  std::set<std::string_view> names;
  const auto zero = [](std::uint32_t) { return std::optional<std::uint8_t>(0); };
  for (const RegisterInfo& r : register_table()) {
    EXPECT_TRUE(names.insert(r.name).second) << r.name;
    EXPECT_EQ(find_register(r.name), &r);
    if (selected(r, zero)) {
      EXPECT_EQ(register_at(r.full_address(), zero), &r) << r.name;
    }
  }
  const auto flshe = [](std::uint32_t a) {
    return std::optional<std::uint8_t>(a == 0xffffc3 ? 0x08 : 0);
  };
  EXPECT_EQ(register_at(0xffff82, zero)->name, "PCSR");
  EXPECT_EQ(register_at(0xffff82, flshe)->name, "EBR1");
  EXPECT_EQ(register_at(0xffff93, zero)->name, "FRC");
  EXPECT_EQ(register_at(0xffff00, zero), nullptr);
}

}  // namespace
}  // namespace kaz::h8s::testing
