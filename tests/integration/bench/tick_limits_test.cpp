// Each limit of the group `tick` is broken: by what the board says, by a line whose delay changes,
// by a clock that runs fast.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "host/link/faulty_link.h"
#include "tests/integration/bench/measured_testing.h"
#include "tests/integration/bench/rewriting_link_testing.h"

namespace kaz::hil {
namespace {

constexpr u16 in_8states(double share) {
  return static_cast<u16>(share * KZ_STATES_PER_TICK / 8);
}

RewritingLink::Change change_health(std::function<void(kz_telemetry_health&)> change) {
  return change_of<kz_telemetry_health>(KZ_TYPE_telemetry_health, kz_unpack_telemetry_health,
                                        kz_pack_telemetry_health, std::move(change));
}
RewritingLink::Change change_statistics(std::function<void(kz_statistics_reply&)> change) {
  return change_of<kz_statistics_reply>(KZ_TYPE_statistics_reply, kz_unpack_statistics_reply,
                                        kz_pack_statistics_reply, std::move(change));
}

BenchReport measure_with(RewritingLink::Change change) {
  lockstep::VirtualBench board(sim::make_native());
  RewritingLink line(board, std::move(change));
  const BenchReport report = measure_tick(line, board);
  EXPECT_EQ(report.measurements.size(), names_of(BenchGroup::tick).size());
  return report;
}

TEST(TickLimits, Median) {
  const BenchReport report = measure_with(
      change_health([](kz_telemetry_health& h) { h.busy_8states = in_8states(0.51); }));
  EXPECT_EQ(failed(report), Names{"tick.median"}) << all_values(report);
  EXPECT_NEAR(value(report, "tick.median"), 51, 0.1);
  const BenchReport below = measure_with(
      change_health([](kz_telemetry_health& h) { h.busy_8states = in_8states(0.49); }));
  EXPECT_EQ(failed(below), Names{}) << all_values(below);
}

TEST(TickLimits, MedianIsThatUnderLoad) {
  lockstep::VirtualBench board(sim::make_native());
  // Long ticks only while cycles come: their requests are on the line.
  int states = 0;
  const auto health = change_health(
      [&](kz_telemetry_health& h) { h.busy_8states = in_8states(states > 0 ? 0.6 : 0.1); });
  RewritingLink line(board, [&](RewritingLink::Body& body) {
    if (body[1] == KZ_TYPE_state_reply) states = 20;
    if (states > 0) --states;
    health(body);
  });
  const BenchReport report = measure_tick(line, board);
  EXPECT_NEAR(value(report, "tick.median"), 60, 0.1);
}

TEST(TickLimits, WorstByStatistics) {
  const BenchReport report = measure_with(
      change_statistics([](kz_statistics_reply& s) { s.worst_8states = in_8states(0.76); }));
  EXPECT_EQ(failed(report), Names{"tick.worst"}) << all_values(report);
}

TEST(TickLimits, WorstByTelemetry) {
  int frames = 0;
  const BenchReport report = measure_with(change_health([&](kz_telemetry_health& h) {
    if (++frames == 300) h.worst_8states = in_8states(0.9);
  }));
  EXPECT_EQ(failed(report), Names{"tick.worst"}) << all_values(report);
}

TEST(TickLimits, Missed) {
  u16 missed = 3;
  const BenchReport report =
      measure_with(change_statistics([&](kz_statistics_reply& s) { s.missed_ticks = missed++; }));
  EXPECT_EQ(failed(report), Names{"tick.missed"}) << all_values(report);
  EXPECT_EQ(value(report, "tick.missed"), 1);
}

TEST(TickLimits, ThoseMissedBeforeAreNotThoseOfNow) {
  const BenchReport report =
      measure_with(change_statistics([](kz_statistics_reply& s) { s.missed_ticks = 7; }));
  EXPECT_EQ(failed(report), Names{}) << all_values(report);
  EXPECT_NE(all_values(report).find("7 more were missed before"), std::string::npos);
}

TEST(TickLimits, Jitter) {
  // Each fifth of a second the line is slower or quicker by 3 ms: a deviation of 1.5 ms.
  std::string schedule;
  for (int i = 0; i < 100; ++i) {
    schedule += "at " + std::to_string(400 * i) + " ms for 200 ms link_delay 0.003 to host\n";
  }
  lockstep::VirtualBench board(sim::make_native());
  const auto faults = faults::Schedule::parse(schedule, "the test");
  ASSERT_TRUE(faults) << faults.error().message;
  host::FaultyLink line(board, board, *faults, 1);
  const BenchReport report = measure_tick(line, board);
  EXPECT_EQ(failed(report), Names{"tick.jitter"}) << all_values(report);
  EXPECT_NEAR(value(report, "tick.jitter"), 1.5, 0.15);
}

TEST(TickLimits, ADelayThatStaysIsNoJitter) {
  lockstep::VirtualBench board(sim::make_native());
  host::FaultyLink line(board, board,
                        *faults::Schedule::parse("at 0 s link_delay 0.015 to host", "the test"), 1);
  EXPECT_EQ(failed(measure_tick(line, board)), Names{});
}

// The host's clock, `rate` times as fast as the board's.
class OtherClock final : public host::Clock, public host::Link {
 public:
  OtherClock(lockstep::VirtualBench& board, double rate) : board_(board), rate_(rate) {}
  Time now() const override { return scaled(board_.now(), rate_); }
  Result<void> sleep_until(Time t) override { return board_.sleep_until(scaled(t, 1 / rate_)); }
  std::string name() const override { return board_.name(); }
  Time byte_time() const override { return board_.byte_time(); }
  Result<void> write(std::span<const std::uint8_t> bytes) override { return board_.write(bytes); }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    return board_.read(bytes, deadline == Time::max() ? deadline : scaled(deadline, 1 / rate_));
  }

 private:
  // Up, so that who waits until a time finds that it has come.
  static Time scaled(Time t, double by) {
    return Time(static_cast<std::int64_t>(std::ceil(static_cast<double>(t.count()) * by)));
  }
  lockstep::VirtualBench& board_;
  double rate_;
};

TEST(TickLimits, ClockError) {
  for (const auto& [rate, ppm] : {std::pair(1.001, -999.0), std::pair(0.999, 1001.0)}) {
    lockstep::VirtualBench board(sim::make_native());
    OtherClock other(board, rate);
    const BenchReport report = measure_tick(other, other);
    EXPECT_EQ(failed(report), Names{"tick.clock_error"}) << all_values(report);
    EXPECT_NEAR(value(report, "tick.clock_error"), ppm, 5);
  }
  lockstep::VirtualBench board(sim::make_native());
  OtherClock near(board, 1.0001);
  const BenchReport report = measure_tick(near, near);
  EXPECT_EQ(failed(report), Names{}) << all_values(report);
  EXPECT_NEAR(value(report, "tick.clock_error"), -100, 5);
}

TEST(TickLimits, WithoutTelemetryNothingCouldBeMeasured) {
  const BenchReport report = measure_with([](RewritingLink::Body& body) {
    if (body[1] == KZ_TYPE_telemetry_health) body.clear();
  });
  EXPECT_EQ(failed(report), (Names{"tick.median", "tick.jitter", "tick.clock_error"}))
      << all_values(report);
}

}  // namespace
}  // namespace kaz::hil
