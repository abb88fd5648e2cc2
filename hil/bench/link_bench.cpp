// Round trips, control cycles, a stream; frames damaged or lost on the line.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/link_bench.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "hil/bench/samples.h"
#include "hil/bench/timed_part.h"

namespace kaz::hil {
namespace {

constexpr const char* kSubject = "link";
constexpr int kStreamPeriodMs = 10;
// What was sent so long before the stream was ended has come by then, or will not.
constexpr std::uint32_t kOnTheWayMs = 30;
constexpr Time kLongestPause = std::chrono::microseconds(2500);
constexpr double kTripsShare = 0.45, kCyclesShare = 0.65;  // of the progress
constexpr int kColumns = 60;

double per_thousand(double count, double of) {
  return of > 0 ? 1000 * count / of : std::numeric_limits<double>::quiet_NaN();
}
double per_thousand_error(double count, double of) {
  return of > 0 ? 1000 * std::sqrt(count) / of : 0;
}

// Frames that were damaged or lost, both ways: by what either end has counted, or, where that is
// more, by the requests that had to be repeated. A reply that came late, after its request had been
// repeated, was not lost.
struct FrameCount {
  double sent = 0, wrong = 0;
};

double damaged(const kz_statistics_reply& board) {
  return board.bad_check + board.bad_stuffing + board.too_short + board.too_long +
         board.line_errors + board.overruns + board.idle;
}

class LinkBench {
 public:
  LinkBench(host::Link& link, host::Clock& clock, const LinkBenchOptions& options,
            BenchJudge& judge)
      : line_(link, clock, options.address), clock_(clock), options_(options), judge_(judge) {}

  Result<void> run() {
    return line_.measure("link", [this] { return measure(); });
  }

 private:
  Result<void> measure() {
    KAZ_TRY(timed_part(judge_, [this](int run) {
      run_ = run;
      return measure_line();
    }));
    return timed_part(judge_, [this](int run) {
      run_ = run;
      return measure_stream();
    });
  }

  Result<void> measure_line() {
    const auto board_before = KAZ_TRY(line_.statistics());
    const host::LinkStatistics before = line_.counts();
    KAZ_TRY(measure_round_trips());
    KAZ_TRY(measure_cycles());
    const host::LinkStatistics after = line_.counts();
    const auto board_after = KAZ_TRY(line_.statistics());
    enter_errors(count_frames(before, after, board_before, board_after));
    return {};
  }

  void progress(double share, const char* what) const {
    if (options_.progress) options_.progress(share, run_text(what, run_));
  }

  // A request at a time, at any phase of the board's tick.
  Result<void> measure_round_trips() {
    std::mt19937_64 random(options_.seed);
    std::vector<double> trips_ms;
    Series course{"round trip", Series::Style::points, {}};
    const Time start = clock_.now();
    for (int i = 0; i < options_.round_trips; ++i) {
      const auto pause = static_cast<std::int64_t>(random() % kLongestPause.count());
      if (auto slept = clock_.sleep_until(clock_.now() + Time(pause)); !slept) return slept;
      const Time sent = clock_.now();
      KAZ_TRY(line_.state());
      trips_ms.push_back(1e3 * seconds(clock_.now() - sent));
      course.points.emplace_back(seconds(sent - start), trips_ms.back());
      if (i % 32 == 0) progress(kTripsShare * i / options_.round_trips, "round trips");
    }
    const double median = quantile(trips_ms, 0.5);
    judge_.enter(kSubject, "link.round_trip_median", median, median_error(trips_ms));
    judge_.enter(kSubject, "link.round_trip_p99", quantile(trips_ms, 0.99));
    judge_.enter(kSubject, "link.round_trip_worst", quantile(trips_ms, 1));
    plot_round_trips(trips_ms, std::move(course));
    return {};
  }

  void plot_round_trips(const std::vector<double>& trips_ms, Series course) {
    Series columns = histogram("round trips", trips_ms, kColumns);
    double highest = 0;
    for (const auto& [x, y] : columns.points) highest = std::max(highest, y);
    Plot plot{"round_trips",
              kSubject,
              "Round trips",
              "round trip, ms",
              "number",
              false,
              {},
              "Time from the first byte of a `state` request to the last byte of its reply. The "
              "wire takes 5 ms of this time, and the board takes 1 to 2.2 ms."};
    plot.series.push_back(std::move(columns));
    for (const auto& [name, text] :
         {std::pair("link.round_trip_median", "limit of the median"),
          std::pair("link.round_trip_p99", "limit of the 99th percentile")}) {
      const double limit = judge_.limits(name).second;
      if (std::isfinite(limit)) plot.series.push_back(limit_line(text, limit, highest));
    }
    judge_.add(std::move(plot));
    judge_.add({"round_trip_course",
                kSubject,
                "Round trips over time",
                "time, s",
                "round trip, ms",
                false,
                {std::move(course)},
                "If a request was repeated, its time includes the timeout."});
  }

  Result<void> measure_cycles() {
    const auto state = KAZ_TRY(line_.state());
    double rate_hz = 0;
    const auto run = [&]() -> Result<void> {
      CycleLoad load(line_, state, [this](double share) {
        progress(kTripsShare + (kCyclesShare - kTripsShare) * share, "control cycles");
      });
      KAZ_TRY(load.run(0, clock_.now() + options_.cycle_time));
      rate_hz = load.rate_hz();
      return {};
    };
    KAZ_TRY(options_.allow_motion ? line_.with_joints_on(run) : run());
    judge_.enter(kSubject, "link.cycle_rate", rate_hz, 0,
                 options_.allow_motion ? ""
                                       : "measured with the joints off: the board refuses the "
                                         "targets, and a refusal is 3 bytes longer than an "
                                         "acknowledgment");
    return {};
  }

  static FrameCount count_frames(const host::LinkStatistics& before,
                                 const host::LinkStatistics& after,
                                 const kz_statistics_reply& board_before,
                                 const kz_statistics_reply& board_after) {
    const auto more = [&](std::uint64_t host::LinkStatistics::*count) {
      return static_cast<double>(after.*count - before.*count);
    };
    using Counts = host::LinkStatistics;
    const double to_host = more(&Counts::replies) + more(&Counts::refused) +
                           more(&Counts::ignored) + more(&Counts::bad_frames);
    const double damage =
        more(&Counts::bad_frames) + std::max(damaged(board_after) - damaged(board_before), 0.0);
    const double repeated = more(&Counts::retries) - more(&Counts::busy) - more(&Counts::ignored);
    return {more(&Counts::requests) + more(&Counts::retries) + to_host, std::max(damage, repeated)};
  }

  void enter_errors(const FrameCount& frames) {
    char note[64];
    std::snprintf(note, sizeof note, "%.0f of %.0f frames", frames.wrong, frames.sent);
    judge_.enter(kSubject, "link.error_rate", per_thousand(frames.wrong, frames.sent),
                 per_thousand_error(frames.wrong, frames.sent), note);
  }

  Result<void> measure_stream() {
    const char* const name = "link.telemetry_loss";
    if (!line_.can_stream()) {
      judge_.leave_out(kSubject, name,
                       "the board is on a shared line, where it sends no telemetry");
      return {};
    }
    (void)line_.take_arrivals();
    const auto first = KAZ_TRY(line_.stream(kStreamPeriodMs, KZ_TELEMETRY_STATE));
    const Time start = clock_.now();
    for (int part = 1; part <= 10; ++part) {
      progress(kCyclesShare + (1 - kCyclesShare) * part / 10, "telemetry");
      if (auto heard = line_.listen_until(start + part * options_.stream_time / 10); !heard) {
        return heard;
      }
    }
    const auto last = KAZ_TRY(line_.stream(0, 0));
    enter_stream(first, last);
    return {};
  }

  // By the ticks of those that came: one each period from `first` on.
  void enter_stream(std::uint32_t first, std::uint32_t last) {
    const std::uint32_t length = std::max(last - first, kOnTheWayMs) - kOnTheWayMs;
    const double due = length / kStreamPeriodMs;
    std::set<std::uint32_t> periods;
    for (const Arrival& arrival : line_.take_arrivals()) {
      const std::uint32_t period = (arrival.tick - first) / kStreamPeriodMs;
      if (period >= 1 && period <= due) periods.insert(period);
    }
    const double lost = due - static_cast<double>(periods.size());
    char note[64];
    std::snprintf(note, sizeof note, "%.0f of %.0f frames", lost, due);
    judge_.enter(kSubject, "link.telemetry_loss", per_thousand(lost, due),
                 per_thousand_error(lost, due), note);
  }

  BoardLine line_;
  host::Clock& clock_;
  const LinkBenchOptions& options_;
  BenchJudge& judge_;
  int run_ = 1;  // of the part
};

}  // namespace

Result<void> bench_link(host::Link& link, host::Clock& clock, const LinkBenchOptions& options,
                        BenchJudge& judge) {
  return LinkBench(link, clock, options, judge).run();
}

}  // namespace kaz::hil
