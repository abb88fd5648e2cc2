// Each limit of the group `link` is broken by a fault of the line, and where it can be by that
// fault alone.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/faulty_link.h"
#include "host/link/stalling_testing.h"
#include "tests/integration/bench/measured_testing.h"
#include "tests/integration/bench/rewriting_link_testing.h"

namespace kaz::hil {
namespace {

using host::FaultyLink;

BenchReport measure_with(const std::string& schedule, std::uint64_t seed = 1) {
  lockstep::VirtualBench board(sim::make_native());
  const auto faults = faults::Schedule::parse(schedule, "the test");
  EXPECT_TRUE(faults) << faults.error().message;
  FaultyLink line(board, board, *faults, seed);
  const BenchReport report = measure_link(line, board);
  EXPECT_EQ(report.measurements.size(), names_of(BenchGroup::link).size());
  return report;
}

TEST(LinkLimits, RoundTripMedian) {
  // 7 ms and 3: those at the end of the scale stay within theirs, cycles become fewer.
  const BenchReport report = measure_with("at 0 s link_delay 0.003 to host");
  EXPECT_TRUE(failed(report).count("link.round_trip_median")) << all_values(report);
  EXPECT_FALSE(failed(report).count("link.round_trip_p99")) << all_values(report);
  EXPECT_FALSE(failed(report).count("link.round_trip_worst")) << all_values(report);
}

TEST(LinkLimits, RoundTripP99) {
  const BenchReport report = measure_with("at 2 s for 0.6 s link_delay 0.008 to board");
  EXPECT_EQ(failed(report), Names{"link.round_trip_p99"}) << all_values(report);
}

TEST(LinkLimits, RoundTripWorst) {
  const BenchReport report = measure_with("at 3 s for 0.05 s link_delay 0.06 to host");
  EXPECT_EQ(failed(report), Names{"link.round_trip_worst"}) << all_values(report);
}

TEST(LinkLimits, CycleRate) {
  // From when the round trips are done.
  const BenchReport report = measure_with("at 9.5 s for 4 s link_delay 0.01");
  EXPECT_TRUE(failed(report).count("link.cycle_rate")) << all_values(report);
  EXPECT_FALSE(failed(report).count("link.round_trip_median")) << all_values(report);
  EXPECT_FALSE(failed(report).count("link.telemetry_loss")) << all_values(report);
}

TEST(LinkLimits, ErrorRateByAnyDamageInAnyDirection) {
  for (const char* fault : {"link_drop 0.0003", "link_flip 0.0003", "link_duplicate 0.0003",
                            "link_insert 0.0003", "link_baud 0.06"}) {
    for (const char* way : {"to board", "to host"}) {
      const std::string schedule = "at 1 s for 11 s " + std::string(fault) + " " + way;
      const BenchReport report = measure_with(
          std::string(fault) == "link_baud 0.06"
              ? "at 1 s for 0.02 s " + std::string(fault) + " " + way + "\nat 3 s for 0.02 s " +
                    fault + " " + way + "\nat 5 s for 0.03 s " + fault + " " + way +
                    "\nat 6 s for 0.03 s " + fault + " " + way + "\nat 7 s for 0.03 s " + fault +
                    " " + way
              : schedule);
      EXPECT_TRUE(failed(report).count("link.error_rate")) << schedule << "\n"
                                                           << all_values(report);
      EXPECT_LT(value(report, "link.error_rate"), 30) << schedule;
    }
  }
}

TEST(LinkLimits, TelemetryLoss) {
  // From when the cycles are done.
  for (const char* fault : {"link_drop 0.001 to host", "link_flip 0.001 to host"}) {
    const BenchReport report = measure_with("at 16 s " + std::string(fault));
    EXPECT_EQ(failed(report), Names{"link.telemetry_loss"}) << all_values(report);
  }
  const BenchReport cut = measure_with("at 17 s for 0.1 s link_cut");
  EXPECT_EQ(failed(cut), Names{"link.telemetry_loss"}) << all_values(cut);
}

TEST(LinkLimits, NoTelemetryAtAllIsAllOfItLost) {
  lockstep::VirtualBench board(sim::make_native());
  RewritingLink silent(board, [](RewritingLink::Body& body) {
    if (body[1] == KZ_TYPE_telemetry_state) body.clear();
  });
  const BenchReport report = measure_link(silent, board);
  EXPECT_EQ(failed(report), Names{"link.telemetry_loss"}) << all_values(report);
  EXPECT_EQ(value(report, "link.telemetry_loss"), 1000);
}

TEST(LinkLimits, TheErrorRateIsThatOfTheLine) {
  // Each byte with a chance of 1/2000: of a frame of n bytes about n/2000.
  const BenchReport report = measure_with("at 1 s for 20 s link_flip 0.0005");
  EXPECT_GT(value(report, "link.error_rate"), 8);
  EXPECT_LT(value(report, "link.error_rate"), 30);
}

// The board and the line are healthy; the program is kept waiting for 80 ms now and then.
TEST(LinkLimits, ALateProgramIsNoFaultOfTheLink) {
  lockstep::VirtualBench board(sim::make_native());
  host::StallingLine late(board, board);
  host::LatenessMeter meter(late, late);
  late.pause = milliseconds(100);
  late.length = milliseconds(80);
  late.stalls = 1000;
  LinkBenchOptions options;
  options.round_trips = 100;
  options.cycle_time = options.stream_time = seconds(1);
  EXPECT_TRUE(failed(measure_link(meter, meter, options)).count("link.round_trip_worst"))
      << "nobody measures lateness";
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none, nullptr, &meter);
  ASSERT_TRUE(bench_link(meter, meter, options, judge));
  EXPECT_EQ(failed(report), Names{}) << all_values(report);
  EXPECT_TRUE(names_with(report, Verdict::undecided).count("link.round_trip_worst"))
      << all_values(report);
  EXPECT_EQ(report.measurements.size(), names_of(BenchGroup::link).size());
}

TEST(LinkLimits, ACableThatIsPulledForGoodIsAnError) {
  lockstep::VirtualBench board(sim::make_native());
  FaultyLink line(board, board, *faults::Schedule::parse("at 2 s link_cut", "the test"), 1);
  BenchReport report;
  const Limits none;
  BenchJudge judge(report, none);
  const auto measured = bench_link(line, board, {}, judge);
  ASSERT_FALSE(measured);
  EXPECT_EQ(measured.error().fault, Fault::environment);
  EXPECT_NE(measured.error().message.find("stopped answering"), std::string::npos);
}

}  // namespace
}  // namespace kaz::hil
