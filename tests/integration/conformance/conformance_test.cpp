// The suite against both engines: all pass, with the same report; the suite against its page.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "hil/conformance/report.h"
#include "host/link/stalling_testing.h"
#include "host/robot/robot.h"
#include "tools/lockstep/virtual_bench.h"

namespace kaz::hil {
namespace {

constexpr unsigned kEverything = kMotion | kFlash | kBench | kExact;

RunReport run(std::unique_ptr<sim::Mcu> mcu, const std::string& filter = "",
              unsigned allowed = kEverything) {
  lockstep::VirtualBench board(std::move(mcu));
  RunOptions options;
  options.filter = filter;
  options.allowed = allowed;
  auto report = run_suite(board, board, &board, Time::zero(), options);
  EXPECT_TRUE(report) << report.error().message;
  return report ? *report : RunReport{};
}

std::string failures(const RunReport& report) {
  std::string text;
  for (const CaseResult& one : report.results) {
    if (one.verdict != Verdict::failed) continue;
    text += one.of->id + ": " + one.message + "\n";
    for (const std::string& line : one.transcript) text += "    " + line + "\n";
  }
  return text;
}

TEST(Suite, HasACaseForEachStatementOfThePageAndNoOther) {
  std::set<std::string> page, shown, ids;
  for (const Statement& statement : statements()) page.insert(statement.id);
  for (const Case& one : cases()) {
    EXPECT_TRUE(ids.insert(one.id).second) << one.id << " stands twice";
    EXPECT_FALSE(one.statements.empty()) << one.id;
    EXPECT_FALSE(one.sentence.empty()) << one.id;
    for (const std::string& id : one.statements) {
      EXPECT_EQ(page.count(id), 1u) << one.id << " shows " << id << ", which the page has not";
      shown.insert(id);
    }
  }
  for (const std::string& id : page) EXPECT_EQ(shown.count(id), 1u) << id << " has no case";
  EXPECT_GT(page.size(), 70u);
  EXPECT_GE(cases().size(), 150u);
}

TEST(Suite, NativeConforms) {
  const RunReport report = run(sim::make_native());
  EXPECT_EQ(report.count(Verdict::passed), static_cast<int>(report.results.size()))
      << failures(report);
}

TEST(Suite, WithoutMotionAndBenchTheRestRunsAndPasses) {
  const RunReport report = run(sim::make_native(), "", kNothing);
  EXPECT_EQ(report.count(Verdict::failed), 0) << failures(report);
  EXPECT_GE(report.count(Verdict::passed), 150);
  EXPECT_GT(report.count(Verdict::left_out), 50);
  for (const CaseResult& one : report.results) {
    if (one.verdict != Verdict::left_out) continue;
    EXPECT_NE(one.message.find("needs "), std::string::npos);
  }
}

TEST(Suite, ABoardAtAnotherAddressConformsToo) {
  for (const std::uint8_t address : {2, 9, 14}) {  // those that cases use themselves
    lockstep::VirtualBench board(sim::make_native());
    {
      auto robot = host::Robot::connect(board, board);
      ASSERT_TRUE(robot) << robot.error().message;
      ASSERT_TRUE(robot->unlock(5));
      ASSERT_TRUE(robot->set_address(address, false));
    }
    board.reset();
    RunOptions options;
    options.filter = "^(address|frame|watchdog)";
    options.address = address;
    options.allowed = kEverything;
    const auto report = run_suite(board, board, &board, Time::zero(), options);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->count(Verdict::failed), 0) << failures(*report);
    EXPECT_EQ(report->count(Verdict::left_out), 1);  // that a fresh board has address 1
  }
}

TEST(Suite, SameSeedSameReport) {
  const auto text = [](const RunReport& report) { return json_text(report, {}); };
  EXPECT_EQ(text(run(sim::make_native(), "frame")), text(run(sim::make_native(), "frame")));
}

TEST(Suite, ADeadLineIsAnErrorNotAFailedCase) {
  lockstep::VirtualBench board(sim::make_native());
  board.set_power(false);
  struct Silent final : host::Link {
    explicit Silent(host::Link& other) : link(other) {}
    std::string name() const override { return "nowhere"; }
    Result<void> write(std::span<const std::uint8_t>) override { return {}; }
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
      return link.read(bytes, deadline);
    }
    host::Link& link;
  } silent(board);
  const auto report = run_suite(silent, board, nullptr, Time::zero(), {});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().fault, Fault::environment);
  EXPECT_NE(report.error().message.find("nowhere"), std::string::npos);
}

// As at a port, where no bench switches it on again.
TEST(Suite, ABoardThatDiesEndsTheRunAndFailsNoCase) {
  lockstep::VirtualBench board(sim::make_native());
  RunOptions options;
  options.filter = "^(frame|request)";
  std::vector<Verdict> verdicts;
  options.progress = [&](const CaseResult& one, std::size_t number, std::size_t) {
    verdicts.push_back(one.verdict);
    if (number == 3) board.set_power(false);
  };
  const auto report = run_suite(board, board, nullptr, std::chrono::milliseconds(20), options);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().fault, Fault::environment);
  EXPECT_NE(report.error().message.find("stopped answering during case "), std::string::npos)
      << report.error().message;
  EXPECT_EQ(verdicts.size(), 3u);
  EXPECT_EQ(std::count(verdicts.begin(), verdicts.end(), Verdict::failed), 0);
}

TEST(Suite, AFilterThatTakesNothingOrIsNoneIsWrongUsage) {
  for (const char* wrong : {"no such case", "("}) {
    const auto taken = chosen(wrong);
    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error().fault, Fault::usage);
  }
  EXPECT_GT(chosen("^SAFE-5$")->size(), 3u);
}

// As at a port, where a busy machine delays what the suite reads: 70 ms late every 60 ms.
struct LateSuite {
  lockstep::VirtualBench board{sim::make_native()};
  host::StallingLine line{board, board};
  host::LatenessMeter meter{line, line};

  CaseResult run(const std::string& filter, int stalls, bool measured = true) {
    line.pause = std::chrono::milliseconds(60);
    line.length = std::chrono::milliseconds(70);
    line.stalls = stalls;
    RunOptions options;
    options.filter = filter;
    options.allowed = kMotion;
    if (measured) options.lateness = &meter;
    const auto report = run_suite(meter, meter, nullptr, std::chrono::milliseconds(20), options);
    EXPECT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->results.size(), 1u);
    return report->results.at(0);
  }
};

constexpr const char* kCoarse = "^timing.reply-coarse$";  // a reply within 60 ms at a port

TEST(LateSuite, ACaseThatFailsByTheProgramsLatenessIsUndecided) {
  constexpr int kForever = 1000;
  EXPECT_EQ(LateSuite().run(kCoarse, kForever, false).verdict, Verdict::failed)
      << "nobody measures";
  const CaseResult late = LateSuite().run(kCoarse, kForever);
  EXPECT_EQ(late.verdict, Verdict::undecided);
  EXPECT_EQ(late.runs, 1 + host::LatenessMeter::kRepetitions);
  EXPECT_NE(late.message.find("the reply took "), std::string::npos) << late.message;
  EXPECT_NE(late.message.find("kept waiting for up to 70 ms"), std::string::npos) << late.message;
}

TEST(LateSuite, ItIsRepeatedAndPassesOnceTheProgramIsPunctual) {
  const CaseResult late = LateSuite().run(kCoarse, 4);
  EXPECT_EQ(late.verdict, Verdict::passed) << late.message;
  EXPECT_GT(late.runs, 1);
  const CaseResult punctual = LateSuite().run(kCoarse, 0);
  EXPECT_EQ(punctual.verdict, Verdict::passed) << punctual.message;
  EXPECT_EQ(punctual.runs, 1);
}

TEST(LateSuite, AFaultyBoardFailsAtOnceWhereTheProgramIsPunctual) {
  LateSuite suite;
  suite.board.set_analog(KZ_ANALOG_SUPPLY, 100);  // far too low: it will not enable
  const CaseResult faulty = suite.run("^motion.target-reached$", 0);
  EXPECT_EQ(faulty.verdict, Verdict::failed);
  EXPECT_EQ(faulty.runs, 1);
  EXPECT_EQ(faulty.message.find("late"), std::string::npos) << faulty.message;
}

#ifdef KAZ_FIRMWARE_IMAGE
TEST(Suite, H8ConformsWithTheSameReportAsNative) {
  auto h8 = sim::make_h8(KAZ_FIRMWARE_IMAGE);
  ASSERT_TRUE(h8) << h8.error().message;
  const RunReport truth = run(std::move(*h8));
  const RunReport fast = run(sim::make_native());
  EXPECT_EQ(truth.count(Verdict::passed), static_cast<int>(truth.results.size()))
      << failures(truth);
  ASSERT_EQ(truth.results.size(), fast.results.size());
  for (std::size_t i = 0; i < truth.results.size(); ++i) {
    EXPECT_EQ(truth.results[i].of, fast.results[i].of);
    EXPECT_EQ(truth.results[i].verdict, fast.results[i].verdict) << truth.results[i].of->id;
    EXPECT_EQ(truth.results[i].message, fast.results[i].message) << truth.results[i].of->id;
  }
}
#endif

}  // namespace
}  // namespace kaz::hil
