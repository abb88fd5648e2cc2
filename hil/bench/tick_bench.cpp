// Telemetry that measures the length of ticks, without load and under it; and the moments at which it
// comes.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/tick_bench.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "hil/bench/line_trouble.h"
#include "hil/bench/samples.h"
#include "hil/bench/timed_part.h"

namespace kaz::hil {
namespace {

constexpr const char* kSubject = "board";
constexpr double kLoadHz = 100;
constexpr double kLoadReached = 0.97;  // less is not the load that was meant
// Under load the wire has no room for more; and not the period of the load, so each phase of a cycle is
// seen.
constexpr int kQuietPeriodMs = 10, kLoadPeriodMs = 33;
constexpr double kPercent = 100, kPerMillion = 1e6;

// Below it there is nothing but the rounding of sums.
double to_nanoseconds(double ms) {
  return std::round(1e6 * ms) / 1e6;
}

class TickBench {
 public:
  TickBench(host::Link& link, host::Clock& clock, const TickBenchOptions& options,
            BenchJudge& judge)
      : line_(link, clock, options.address), clock_(clock), options_(options), judge_(judge) {}

  Result<void> run() {
    return line_.measure("tick", [this] {
      return timed_part(
          judge_,
          [this](int run) {
            run_ = run;
            return measure();
          },
          Time::zero(), [this] { return take_line_trouble(); });
    });
  }

 private:
  Result<void> measure() {
    const auto before = KAZ_TRY(line_.statistics());
    first_tick_ = before.tick;
    quiet_.clear();
    if (auto ran = keep_quiet(0, "without load"); !ran) return ran;
    if (auto ran = put_load(); !ran) return ran;
    if (auto ran = keep_quiet(0.7, "without load again"); !ran) return ran;
    const auto after = KAZ_TRY(line_.statistics());
    enter_lengths(before, after);
    enter_moments();
    return {};
  }

  void progress(double share, const char* what) const {
    if (options_.progress) options_.progress(share, run_text(what, run_));
  }

  std::string take_line_trouble() {
    const host::LinkStatistics now = line_.counts();
    return line_trouble(std::exchange(counted_, now), now);
  }

  Result<void> stream(int period_ms) {
    if (!line_.can_stream()) return {};
    const auto streamed = line_.stream(period_ms, KZ_TELEMETRY_HEALTH);
    return streamed ? Result<void>() : tl::unexpected(streamed.error());
  }

  // Nothing but telemetry is on the line then, so that nothing delays it.
  Result<void> keep_quiet(double done, const char* what) {
    if (auto streamed = stream(kQuietPeriodMs); !streamed) return streamed;
    (void)line_.take_arrivals();
    const Time start = clock_.now();
    for (int part = 1; part <= 8; ++part) {
      if (auto heard = line_.listen_until(start + part * options_.quiet_time / 16); !heard) {
        return heard;
      }
      progress(done + 0.3 * part / 8, what);
    }
    for (const Arrival& arrival : line_.take_arrivals()) quiet_.push_back(arrival);
    return {};
  }

  Result<void> put_load() {
    const auto state = KAZ_TRY(line_.state());
    const auto run = [&]() -> Result<void> {
      KAZ_TRY(stream(kLoadPeriodMs));
      (void)line_.take_arrivals();
      CycleLoad load(line_, state,
                     [this](double share) { progress(0.3 + 0.4 * share, "under load"); });
      KAZ_TRY(load.run(kLoadHz, clock_.now() + options_.load_time));
      load_hz_ = load.rate_hz();
      loaded_ = line_.take_arrivals();
      return {};
    };
    return options_.allow_motion ? line_.with_joints_on(run) : run();
  }

  void enter_lengths(const kz_statistics_reply& before, const kz_statistics_reply& after) {
    constexpr double kShare = kPercent * 8 / KZ_STATES_PER_TICK;
    std::vector<double> lengths;
    for (const Arrival& arrival : loaded_) lengths.push_back(kPercent * arrival.busy);
    std::string note = options_.allow_motion ? "" : "joints off";
    if (load_hz_ < kLoadReached * kLoadHz) {
      char text[80];
      std::snprintf(text, sizeof text, "%sthe link carried only %.0f control cycles per second",
                    note.empty() ? "" : ", ", load_hz_);
      note += text;
    }
    double worst = kShare * after.worst_8states;
    for (const auto* frames : {&quiet_, &loaded_}) {
      for (const Arrival& arrival : *frames) worst = std::max(worst, kPercent * arrival.worst);
    }
    if (quantile(lengths, 1) == 0 && worst == 0) {
      constexpr const char* kNoTimer = "this board has no timer to measure its ticks";
      judge_.leave_out(kSubject, "tick.median", kNoTimer);
      judge_.leave_out(kSubject, "tick.worst", kNoTimer);
      return enter_missed(before, after);
    }
    if (line_.can_stream()) {
      judge_.enter(kSubject, "tick.median", quantile(lengths, 0.5), median_error(lengths), note);
    } else {
      judge_.leave_out(kSubject, "tick.median", kNoStream);
    }
    judge_.enter(kSubject, "tick.worst", worst);
    enter_missed(before, after);
    if (line_.can_stream()) plot_lengths();
  }

  void enter_missed(const kz_statistics_reply& before, const kz_statistics_reply& after) {
    judge_.enter(kSubject, "tick.missed", after.missed_ticks - before.missed_ticks, 0,
                 before.missed_ticks == 0 ? ""
                                          : std::to_string(before.missed_ticks) +
                                                " more were missed before this measurement");
  }

  double board_seconds(const Arrival& arrival) const {
    return 1e-3 * static_cast<double>(arrival.tick - first_tick_);
  }

  void plot_lengths() {
    const auto series = [&](const char* name, const std::vector<Arrival>& frames) {
      Series one{name, Series::Style::points, {}};
      for (const Arrival& arrival : frames) {
        one.points.emplace_back(board_seconds(arrival), kPercent * arrival.busy);
      }
      return one;
    };
    Series worst{"longest since reset", Series::Style::line, {}};
    std::vector<Arrival> all = quiet_;
    all.insert(all.end(), loaded_.begin(), loaded_.end());
    std::sort(all.begin(), all.end(),
              [](const Arrival& a, const Arrival& b) { return a.at < b.at; });
    for (const Arrival& arrival : all) {
      worst.points.emplace_back(board_seconds(arrival), kPercent * arrival.worst);
    }
    judge_.add({"tick_length",
                kSubject,
                "Length of ticks",
                "board time, s",
                "share of a tick, %",
                false,
                {series("telemetry alone", quiet_), series("18 joints at 100 Hz", loaded_), worst},
                "Each point is the length of one tick, measured by the board."});
  }

  // Against the straight line through all moments, whose slope is how the clocks differ.
  void enter_moments() {
    if (!line_.can_stream()) {
      judge_.leave_out(kSubject, "tick.jitter", kNoStream);
      judge_.leave_out(kSubject, "tick.clock_error", kNoStream);
      return;
    }
    std::vector<std::pair<double, double>> moments;
    for (const Arrival& arrival : quiet_) {
      moments.emplace_back(board_seconds(arrival), seconds(arrival.at - quiet_.front().at));
    }
    const Line line = fit_line(moments);
    std::vector<double> late_ms;
    Series plotted{"telemetry", Series::Style::points, {}};
    for (const auto& [tick_s, at_s] : moments) {
      late_ms.push_back(to_nanoseconds(1e3 * (at_s - line.at_zero - line.slope * tick_s)));
      plotted.points.emplace_back(tick_s, late_ms.back());
    }
    const double jitter = standard_deviation(late_ms);
    judge_.enter(
        kSubject, "tick.jitter", jitter,
        jitter / std::sqrt(2.0 * static_cast<double>(std::max<std::size_t>(late_ms.size(), 1))));
    if (options_.one_clock) {
      judge_.leave_out(kSubject, "tick.clock_error",
                       "time is simulated, so board and bench share one clock");
    } else {
      judge_.enter(kSubject, "tick.clock_error", kPerMillion * (1 / line.slope - 1),
                   kPerMillion * line.slope_error);
    }
    judge_.add({"arrival",
                kSubject,
                "Arrival of telemetry",
                "board time, s",
                "delay, ms",
                false,
                {std::move(plotted)},
                "Delay of each telemetry frame from its tick to its arrival, without load. The "
                "mean delay is subtracted."});
  }

  static constexpr const char* kNoStream =
      "the board is on a shared line, where it sends no telemetry";

  BoardLine line_;
  host::Clock& clock_;
  const TickBenchOptions& options_;
  BenchJudge& judge_;
  int run_ = 1;
  std::uint32_t first_tick_ = 0;
  std::vector<Arrival> quiet_, loaded_;
  double load_hz_ = 0;
  host::LinkStatistics counted_;  // by take_line_trouble()
};

}  // namespace

Result<void> bench_tick(host::Link& link, host::Clock& clock, const TickBenchOptions& options,
                        BenchJudge& judge) {
  return TickBench(link, clock, options, judge).run();
}

}  // namespace kaz::hil
