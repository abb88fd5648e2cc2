// Every limit of the table can fail, and files with other limits.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "hil/bench/measurement.h"
#include "hil/bench/report/numbers.h"
#include "hil/bench/timed_part.h"

namespace kaz::hil {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

Measurement judged(const std::string& name, double value, const Limits& limits = {}) {
  BenchReport report;
  BenchJudge(report, limits).enter("board", name, value);
  return report.measurements.at(0);
}

// A value that lies inside, and how far to go from a limit to be past it.
double inside(const MeasurementInfo& info) {
  if (std::isinf(info.low)) return info.high;
  return std::isinf(info.high) ? info.low : (info.low + info.high) / 2;
}
double a_little(double limit) {
  return 1e-6 * (1 + std::abs(limit));
}

TEST(MeasurementTable, NamesAreUniqueAndEachHasALimitAndAMeaning) {
  std::set<std::string> names;
  for (const MeasurementInfo& info : measurement_infos()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name << " stands twice";
    EXPECT_TRUE(std::isfinite(info.low) || std::isfinite(info.high)) << info.name;
    EXPECT_LE(info.low, info.high) << info.name;
    EXPECT_FALSE(info.text.empty()) << info.name;
    EXPECT_EQ(find_measurement(info.name), &info);
    const std::string prefix = std::string(text(info.group)) + ".";
    EXPECT_EQ(info.name.rfind(prefix, 0) == 0, info.group != BenchGroup::motor) << info.name;
  }
  EXPECT_GE(names.size(), 34u);
  EXPECT_EQ(find_measurement("stall"), nullptr);
}

TEST(MeasurementTable, EachLimitFailsJustBeyondAndPassesAt) {
  for (const MeasurementInfo& info : measurement_infos()) {
    EXPECT_EQ(judged(info.name, inside(info)).verdict, Verdict::passed) << info.name;
    if (std::isfinite(info.low)) {
      EXPECT_EQ(judged(info.name, info.low).verdict, Verdict::passed) << info.name;
      const Measurement below = judged(info.name, info.low - a_little(info.low));
      EXPECT_EQ(below.verdict, Verdict::failed) << info.name;
      EXPECT_NE(below.message.find("is below the limit of "), std::string::npos) << below.message;
    }
    if (std::isfinite(info.high)) {
      EXPECT_EQ(judged(info.name, info.high).verdict, Verdict::passed) << info.name;
      const Measurement above = judged(info.name, info.high + a_little(info.high));
      EXPECT_EQ(above.verdict, Verdict::failed) << info.name;
      EXPECT_NE(above.message.find("is above the limit of "), std::string::npos) << above.message;
    }
  }
}

TEST(MeasurementTable, NothingMeasuredFailsEverywhere) {
  for (const MeasurementInfo& info : measurement_infos()) {
    const Measurement none = judged(info.name, std::nan(""));
    EXPECT_EQ(none.verdict, Verdict::failed) << info.name;
    EXPECT_EQ(none.message, "the measurement gave no value");
  }
}

TEST(BenchJudge, EntersMeasurementsAndCallsTheListener) {
  BenchReport report;
  const Limits limits;
  std::vector<std::string> reported;
  BenchJudge judge(report, limits,
                   [&](const Measurement& one) { reported.push_back(one.of->name); });
  judge.enter("neck_pan", "backlash", 0.4, 0.02, "cold");
  judge.enter("neck_pan", "backlash", 0.7, 0.02, "warm");
  judge.leave_out("neck_pan", "stall.slope", "needs --allow-motion");
  EXPECT_EQ(reported, (std::vector<std::string>{"backlash", "backlash", "stall.slope"}));
  EXPECT_EQ(report.count(Verdict::passed), 1);
  EXPECT_EQ(report.count(Verdict::failed), 1);
  EXPECT_EQ(report.count(Verdict::left_out), 1);
  EXPECT_EQ(report.measurements[0].subject, "neck_pan");
  EXPECT_EQ(report.measurements[0].error, 0.02);
  EXPECT_EQ(report.measurements[0].message, "cold");
  EXPECT_EQ(report.measurements[1].message, "0.7 deg is above the limit of 0.6 deg; warm");
  EXPECT_TRUE(std::isnan(report.measurements[2].value));
  EXPECT_EQ(report.measurements[2].message, "needs --allow-motion");
  EXPECT_THROW(judge.enter("board", "no.such", 0), std::logic_error);
}

// The clock of the test, on which only lateness passes.
struct LateClock final : host::Link, host::Clock {
  std::string name() const override { return "late"; }
  Result<void> write(std::span<const std::uint8_t>) override { return {}; }
  Result<std::size_t> read(std::span<std::uint8_t>, Time) override { return 0; }
  Time now() const override { return time; }
  Result<void> sleep_until(Time t) override {
    time = t + late;
    return {};
  }
  Time time{}, late{};
};

class JudgeOfTimes : public ::testing::Test {
 protected:
  // A part that waits for a second, and enters a round trip and the board's own missed ticks.
  Result<void> measure(double round_trip_ms, double missed = 0, int late_runs = 100) {
    return judge_.timed([=, this]() -> Result<void> {
      clock_.late = std::chrono::milliseconds(runs_++ < late_runs ? 40 : 0);
      KAZ_TRY(meter_.sleep_until(meter_.now() + std::chrono::seconds(1)));
      judge_.enter("link", "link.round_trip_worst", round_trip_ms);
      judge_.enter("board", "tick.missed", missed);
      judge_.add({"trips", "link", "Trips", "x", "y", false, {}, ""});
      return {};
    });
  }
  LateClock clock_;
  host::LatenessMeter meter_{clock_, clock_};
  BenchReport report_;
  const Limits limits_;
  int runs_ = 0, listened_ = 0;
  BenchJudge judge_{report_, limits_, [this](const Measurement&) { ++listened_; }, &meter_};
};

TEST_F(JudgeOfTimes, AFailureWhileThisMachineIsLateIsUndecided) {
  ASSERT_TRUE(measure(90, 2));
  EXPECT_EQ(runs_, 1 + host::LatenessMeter::kRepetitions);
  ASSERT_EQ(report_.measurements.size(), 2u);
  EXPECT_EQ(report_.plots.size(), 1u);
  EXPECT_EQ(listened_, 2);
  EXPECT_EQ(report_.measurements[0].verdict, Verdict::undecided);
  EXPECT_NE(
      report_.measurements[0].message.find("; but this program was kept waiting for up to 40 ms"),
      std::string::npos)
      << report_.measurements[0].message;
  EXPECT_EQ(report_.measurements[1].verdict, Verdict::failed)
      << "the board counts its missed ticks itself";
}

TEST_F(JudgeOfTimes, ItIsRepeatedUntilThisMachineIsPunctual) {
  ASSERT_TRUE(measure(90, 0, 2));
  EXPECT_EQ(runs_, 3);
  EXPECT_EQ(report_.measurements.size(), 2u);
  EXPECT_EQ(report_.measurements[0].verdict, Verdict::failed)
      << "punctual, and as slow: it is the board";
}

TEST_F(JudgeOfTimes, AnythingElseIsJudgedAtOnce) {
  ASSERT_TRUE(measure(90, 0, 0));
  EXPECT_EQ(report_.measurements[0].verdict, Verdict::failed) << "this machine was punctual";
  ASSERT_TRUE(measure(10));
  EXPECT_EQ(report_.measurements[2].verdict, Verdict::passed) << "late, and good enough";
  ASSERT_TRUE(measure(10, 1));
  EXPECT_EQ(report_.measurements[5].verdict, Verdict::failed);
  EXPECT_EQ(runs_, 3);
}

// A motor's part, which the board times: only a stop counts, but for all of it.
TEST_F(JudgeOfTimes, WhatBearsLatenessIsInDoubtAfterAStopAlone) {
  const auto part = [this](int late_ms) {
    return judge_.timed(
        [=, this]() -> Result<void> {
          ++runs_;
          clock_.late = std::chrono::milliseconds(late_ms);
          KAZ_TRY(meter_.sleep_until(meter_.now() + std::chrono::seconds(1)));
          judge_.enter("neck_pan", "backlash", 90);
          return {};
        },
        std::chrono::milliseconds(100));
  };
  ASSERT_TRUE(part(90));
  EXPECT_EQ(runs_, 1);
  EXPECT_EQ(report_.measurements[0].verdict, Verdict::failed);
  ASSERT_TRUE(part(300));
  EXPECT_EQ(runs_, 2 + host::LatenessMeter::kRepetitions);
  ASSERT_EQ(report_.measurements.size(), 2u);
  EXPECT_EQ(report_.measurements[1].verdict, Verdict::undecided);
}

TEST_F(JudgeOfTimes, APartThatIsCutShortWhileThisMachineWasLateIsUndecided) {
  const auto cut_short = [this](int late_ms) {
    return timed_part(judge_, [=, this](int run) -> Result<void> {
      EXPECT_EQ(run, 1);
      clock_.late = std::chrono::milliseconds(late_ms);
      KAZ_TRY(meter_.sleep_until(meter_.now() + std::chrono::seconds(1)));
      judge_.enter("link", "link.round_trip_worst", 90);
      judge_.enter("link", "link.cycle_rate", 110);
      return fail(Fault::interrupted, "interrupted");
    });
  };
  ASSERT_FALSE(cut_short(40));
  ASSERT_EQ(report_.measurements.size(), 2u);
  EXPECT_EQ(report_.measurements[0].verdict, Verdict::undecided);
  EXPECT_NE(report_.measurements[0].message.find("kept waiting for up to 40 ms"), std::string::npos)
      << report_.measurements[0].message;
  EXPECT_EQ(report_.measurements[1].verdict, Verdict::passed);
  ASSERT_FALSE(cut_short(0));
  EXPECT_EQ(report_.measurements[2].verdict, Verdict::failed) << "this machine was punctual";
}

TEST_F(JudgeOfTimes, OnADisturbedLineOnlyTheLineItselfFails) {
  const auto part = [this](int disturbed_runs) {
    runs_ = 0;
    return timed_part(
        judge_,
        [this](int run) -> Result<void> {
          runs_ = run;
          judge_.enter("l_knee", "step.error", 99);
          judge_.enter("link", "link.error_rate", 99);
          return {};
        },
        Time::zero(),
        [this, disturbed_runs] {
          return runs_ > 0 && runs_ <= disturbed_runs
                     ? std::string("on the line 2 replies were lost")
                     : std::string();
        });
  };
  ASSERT_TRUE(part(100));
  EXPECT_EQ(runs_, 1 + host::LatenessMeter::kRepetitions);
  ASSERT_EQ(report_.measurements.size(), 2u);
  EXPECT_EQ(report_.measurements[0].verdict, Verdict::undecided);
  EXPECT_NE(report_.measurements[0].message.find(
                "; but on the line 2 replies were lost (the line was disturbed in all 4 runs)"),
            std::string::npos)
      << report_.measurements[0].message;
  EXPECT_EQ(report_.measurements[1].verdict, Verdict::failed);
  EXPECT_TRUE(report_.doubts(Measurement::Doubt::line));
  ASSERT_TRUE(part(1));
  EXPECT_EQ(runs_, 2);
  ASSERT_EQ(report_.measurements.size(), 4u);
  EXPECT_EQ(report_.measurements[2].verdict, Verdict::failed) << "on a healthy line it is so, too";
}

TEST_F(JudgeOfTimes, WhatFailedBeforeTheBoardWasLostIsUndecided) {
  ASSERT_FALSE(timed_part(
      judge_,
      [this](int) -> Result<void> {
        judge_.enter("l_knee", "step.error", 99);
        return fail(Fault::environment, "the board stopped answering");
      },
      Time::zero(),
      [] { return std::string("on the line the connection to the board was lost"); }));
  ASSERT_EQ(report_.measurements.size(), 1u);
  EXPECT_EQ(report_.measurements[0].verdict, Verdict::undecided);
  EXPECT_NE(
      report_.measurements[0].message.find("the run ended before the measurement was repeated"),
      std::string::npos);
}

TEST_F(JudgeOfTimes, ARepetitionIsNamed) {
  std::vector<std::string> names;
  ASSERT_TRUE(timed_part(judge_, [&](int run) -> Result<void> {
    names.push_back(run_text("telemetry", run));
    clock_.late = std::chrono::milliseconds(run == 1 ? 40 : 0);
    KAZ_TRY(meter_.sleep_until(meter_.now() + std::chrono::seconds(1)));
    judge_.enter("link", "link.round_trip_worst", run == 1 ? 90 : 10);
    return {};
  }));
  EXPECT_EQ(names,
            (std::vector<std::string>{
                "telemetry",
                "repeated because this machine was late or the line was disturbed: telemetry"}));
  EXPECT_EQ(report_.count(Verdict::passed), 1);
}

TEST_F(JudgeOfTimes, NothingIsDecidedOnceTheOtherEndIsGone) {
  host::LatenessMeter meter(clock_, clock_,
                            []() -> Result<Time> { return fail(Fault::environment, "gone"); });
  BenchJudge judge(report_, limits_, nullptr, &meter);
  const auto ran = judge.timed([&]() -> Result<void> {
    judge.enter("board", "tick.missed", 0);
    judge.enter("link", "link.round_trip_worst", 90);
    return {};
  });
  ASSERT_FALSE(ran);
  EXPECT_EQ(ran.error().fault, Fault::environment);
  ASSERT_EQ(report_.measurements.size(), 1u) << "that has passed";
  EXPECT_EQ(report_.count(Verdict::failed), 0);
}

// The default limits of a start are for one disc; limits that somebody gives are for theirs.
TEST(BenchJudge, DefaultLimitsOfAnotherConditionDoNotApply) {
  for (const bool given : {false, true}) {
    BenchReport report;
    const Limits limits =
        given ? Limits{{"start.time_constant", {6, 11}}} : Limits{{"backlash", {0, 1}}};
    BenchJudge judge(report, limits);
    judge.enter_without_default_limits("neck", "start.time_constant", 40, 1, "another disc");
    ASSERT_EQ(report.measurements.size(), 1u);
    EXPECT_EQ(report.measurements[0].verdict, given ? Verdict::failed : Verdict::left_out);
    EXPECT_EQ(report.measurements[0].value, 40);
    EXPECT_NE(report.measurements[0].message.find("another disc"), std::string::npos);
  }
}

TEST(LimitFile, ReplacesLimits) {
  const auto limits = parse_limits(
      R"({"backlash": {"low": 1, "high": 2}, "stall.slope": {"low": null, "high": 0.1},
          "pot.noise": {}})",
      "limits.json");
  ASSERT_TRUE(limits) << limits.error().message;
  EXPECT_EQ(judged("backlash", 1.5, *limits).verdict, Verdict::passed);
  EXPECT_EQ(judged("backlash", 0.4, *limits).verdict, Verdict::failed);
  const Measurement slope = judged("stall.slope", 0, *limits);
  EXPECT_EQ(slope.verdict, Verdict::passed);
  EXPECT_EQ(slope.low, -kInfinite);
  EXPECT_EQ(slope.high, 0.1);
  EXPECT_EQ(judged("pot.noise", 1e9, *limits).verdict, Verdict::passed);
  EXPECT_EQ(judged("pot.offset", 0, *limits).high, find_measurement("pot.offset")->high);
}

// As `kaz bench list --json` prints them.
TEST(LimitFile, AListOfMeasurementsIsOne) {
  const auto limits = parse_limits(
      R"([{"name": "backlash", "group": "motor", "unit": "mrad", "low": 1, "high": 2, "text": "t"},
          {"name": "stall.slope", "low": null, "high": 0.1}])",
      "limits.json");
  ASSERT_TRUE(limits) << limits.error().message;
  EXPECT_EQ(limits->size(), 2u);
  EXPECT_EQ(judged("backlash", 0.4, *limits).verdict, Verdict::failed);
  EXPECT_EQ(judged("stall.slope", 0, *limits).low, -kInfinite);
}

TEST(LimitFile, EveryMistakeIsOneSentenceWithFileAndKey) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"{\n\"backlash\": {\"low\": 1,}}", "line 2 is not valid JSON"},
      {"", "is not valid JSON"},
      {"{}", "it contains no measurement"},
      {"[]", "it contains no measurement"},
      {"1", "must be an object"},
      {"[1]", "entry 0 of the list has no \"name\""},
      {R"([{"name": "backlash", "lo": 3}])", "'backlash' has an unknown key 'lo'"},
      {R"({"backlsh": {}})", "no measurement 'backlsh'"},
      {R"({"backlash": 3})", "'backlash' must have the form"},
      {R"({"backlash": {"lo": 3}})", "'backlash' has an unknown key 'lo'"},
      {R"({"backlash": {"low": "3"}})", "'low' of 'backlash' must be a number or null"},
      {R"({"backlash": {"low": 3, "high": 2}})", "'low' of 'backlash' is above"},
      {R"({"backlash": {"low": 1e999}})", "too large"},
      {R"({"backlash": {"high": 1}, "backlash": {"high": 100}})", "\"backlash\" occurs twice"},
      {R"({"backlash": {"high": 1, "high": 100}})", "\"high\" occurs twice"},
  };
  for (const auto& [json, part] : mistakes) {
    const auto limits = parse_limits(json, "my/limits.json");
    ASSERT_FALSE(limits) << json;
    EXPECT_EQ(limits.error().fault, Fault::usage);
    EXPECT_EQ(limits.error().message.rfind("limit file 'my/limits.json': ", 0), 0u)
        << limits.error().message;
    EXPECT_NE(limits.error().message.find(part), std::string::npos) << limits.error().message;
    EXPECT_EQ(limits.error().message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace kaz::hil
