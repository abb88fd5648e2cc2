// Measures of two runs and their standard errors.
// SPDX-License-Identifier: Apache-2.0
#include "tools/compare/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include "host/robot/posture.h"
#include "shared/base/angle.hpp"
#include "shared/base/counted.hpp"

namespace kaz::tools {
namespace {

constexpr int kBlocks = 8;
// Student's t at 0.9995 for 7 to 14 degrees of freedom: one in a thousand equal pairs is beyond, either way.
constexpr std::array kStudent{5.41, 5.04, 4.78, 4.59, 4.44, 4.32, 4.22, 4.14};
constexpr double kGrid_s = 1e-3;        // of a CommandCurve
constexpr double kMaxLag_s = 0.3;       // joints that are further behind do not follow
constexpr double kLagStep_s = 2e-3;     // of the search
constexpr double kMoved = 2 * kDegree;  // a command that changes less shows no lag
// Where in its gear's play a joint is carried along differs from run to run, and lasts for about that long.
constexpr double kPlay = 0.4 * kDegree, kPlayStays_s = 1;
constexpr double kMaxLagInPlay_s = 0.02;  // a healthy joint's lag: nothing is left of it then
constexpr double kSameTarget =
    1 * kDegree;  // ramps begin where joints stand, which differs by their play

const char* joint_name(int joint) {
  return host::joint_table()[static_cast<std::size_t>(joint)].name;
}

// Which of the blocks of a run.
int block_of(double time_s, double duration_s) {
  return std::clamp(static_cast<int>(time_s / std::max(duration_s, 1e-9) * kBlocks), 0,
                    kBlocks - 1);
}

// `measure` of the data of all blocks but `without` (-1: of all); nothing where there are too few data.
using BlockMeasure = std::function<std::optional<double>(int without)>;

Measured measured(const BlockMeasure& measure) {
  const auto whole = measure(-1);
  if (!whole) return {};
  std::vector<double> parts;
  for (int k = 0; k < kBlocks; ++k)
    if (const auto part = measure(k)) parts.push_back(*part);
  const auto n = static_cast<double>(parts.size());
  if (n < kBlocks / 2.0) return {};
  const double mean = std::accumulate(parts.begin(), parts.end(), 0.0) / n;
  double sum = 0;
  for (const double part : parts) sum += (part - mean) * (part - mean);
  return {true, *whole, std::sqrt((n - 1) / n * sum)};
}

// A value at a time.
struct Point {
  double time_s = 0, value = 0;
};

enum class Statistic { mean, median, p95, least };

std::optional<double> statistic_of(std::vector<double> values, Statistic kind) {
  if (values.empty()) return std::nullopt;
  const auto quantile = [&](double q) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  switch (kind) {
    case Statistic::mean:
      return std::accumulate(values.begin(), values.end(), 0.0) /
             static_cast<double>(values.size());
    case Statistic::median:
      return quantile(0.5);
    case Statistic::p95:
      return quantile(0.95);
    case Statistic::least:
      break;
  }
  return *std::ranges::min_element(values);
}

Measured statistic(const std::vector<Point>& points, double duration_s, Statistic kind) {
  constexpr std::size_t kFewest = 2 * kBlocks;
  if (points.size() < kFewest) return {};
  return measured([&](int without) {
    std::vector<double> values;
    for (const Point& point : points)
      if (block_of(point.time_s, duration_s) != without) values.push_back(point.value);
    return statistic_of(std::move(values), kind);
  });
}

// How a joint follows its command: sums over the samples of each block, for each lag that is tried.
class Following {
 public:
  Following(const RunTrace& trace, int joint) {
    const CommandCurve command = command_curve(trace, joint);
    if (command.angle_rad.empty()) return;
    const auto [low, high] = std::ranges::minmax(command.angle_rad);
    if (high - low < kMoved) return;
    std::vector<double> times;
    for (const RunTrace::Posture& posture : trace.postures) {
      if (!command.covers(posture.time_s - kMaxLag_s)) continue;
      ++samples_;
      times.push_back(posture.time_s);
      const auto block = static_cast<std::size_t>(block_of(posture.time_s, trace.duration_s));
      for (std::size_t k = 0; k < kLags; ++k) {
        const double error = posture.angle_rad[static_cast<std::size_t>(joint)] -
                             command.at(posture.time_s - static_cast<double>(k) * kLagStep_s);
        Sums& sums = sums_[k][block];
        sums.count += 1;
        sums.first += error;
        sums.second += error * error;
      }
    }
    find_lag_in_play(command, times);
  }

  bool known() const { return samples_ >= 50; }

  // The lag with the least scatter about a constant error, s. Between the steps: the parabola through the
  // neighbours' variances.
  std::optional<double> lag(int without) const {
    const auto best = best_lag(without);
    if (!best) return std::nullopt;
    const std::size_t k = *best;
    double step = static_cast<double>(k);
    if (k > 0 && k + 1 < kLags) {
      const double before = total(k - 1, without).variance(), here = total(k, without).variance(),
                   after = total(k + 1, without).variance();
      const double bend = before - 2 * here + after;
      if (bend > 0) step += 0.5 * (before - after) / bend;
    }
    return step * kLagStep_s;
  }
  // Mean of angle less command at that lag, rad.
  std::optional<double> offset(int without) const {
    const auto best = best_lag(without);
    if (!best) return std::nullopt;
    return total(*best, without).mean();
  }
  // By how much half of the play shifts that lag, s: a constant error e of the angle while the joint moves
  // at a speed v is worth e / v; those of many motions are independent and average. Of the motion that is
  // left when the command has passed the play: within it the shaft need not follow.
  double lag_in_play_s() const { return lag_in_play_s_; }
  // What is left then: root mean square, rad.
  std::optional<double> rest(int without) const {
    const auto best = best_lag(without);
    if (!best) return std::nullopt;
    return std::sqrt(std::max(0.0, total(*best, without).variance()));
  }

 private:
  struct Sums {
    double count = 0, first = 0, second = 0;
    double mean() const { return first / count; }
    double variance() const { return second / count - mean() * mean(); }
  };
  static constexpr std::size_t kLags = static_cast<std::size_t>(kMaxLag_s / kLagStep_s) + 1;

  // The standard error of a lag by least squares, whose derivative is the speed less its mean (the offset is
  // fitted, too), for errors of half the play whose correlation decays exponentially.
  void find_lag_in_play(const CommandCurve& command, const std::vector<double>& times) {
    const auto best = best_lag(-1);
    if (!best) return;
    const double lag_s = static_cast<double>(*best) * kLagStep_s;
    std::vector<double> moved;
    double carried = command.at(times.front() - lag_s), mean = 0;
    for (const double time_s : times) {
      const double to = command.at(time_s - lag_s);
      const double before = carried;
      carried = std::clamp(carried, to - kPlay / 2, to + kPlay / 2);
      moved.push_back(carried - before);
    }
    // Speeds times the time of a sample, of which the run has enough for sums to be integrals.
    const double step_s = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    for (const double one : moved) mean += one / static_cast<double>(moved.size());
    double squares = 0, pairs = 0, tail = 0;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const double one = moved[i] - mean;
      if (i > 0) tail *= std::exp(-(times[i] - times[i - 1]) / kPlayStays_s);
      pairs += 2 * one * tail + one * one;
      tail += one;
      squares += one * one / step_s;
    }
    lag_in_play_s_ = squares > 0 ? kPlay / 2 * std::sqrt(std::max(0.0, pairs)) / squares : 1e9;
  }

  Sums total(std::size_t lag, int without) const {
    Sums all;
    for (int b = 0; b < kBlocks; ++b) {
      if (b == without) continue;
      const Sums& one = sums_[lag][static_cast<std::size_t>(b)];
      all.count += one.count;
      all.first += one.first;
      all.second += one.second;
    }
    return all;
  }
  std::optional<std::size_t> best_lag(int without) const {
    std::optional<std::size_t> best;
    double least = 0;
    for (std::size_t k = 0; k < kLags; ++k) {
      const Sums sums = total(k, without);
      if (sums.count < 20) return std::nullopt;
      if (!best || sums.variance() < least) {
        best = k;
        least = sums.variance();
      }
    }
    return best;
  }

  std::size_t samples_ = 0;
  double lag_in_play_s_ = 1e9;
  std::array<std::array<Sums, kBlocks>, kLags> sums_{};
};

Measured scaled(Measured value, double by) {
  value.value *= by;
  value.error *= by;
  return value;
}

Measured count(double value) {
  return {true, value, 0};
}

class Measurer {
 public:
  Measurer(const RunTrace& a, const RunTrace& b) : a_(a), b_(b) {}

  std::vector<Measure> all() {
    for (int j = 0; j < KZ_JOINTS; ++j) joint(j);
    supply();
    link();
    pictures();
    return std::move(measures_);
  }

 private:
  void add(const std::string& name, const char* unit, const char* meaning, double resolution,
           const std::function<Measured(const RunTrace&)>& measure) {
    Measure one{name, unit, meaning, resolution, measure(a_), measure(b_)};
    if (one.a.known || one.b.known) measures_.push_back(one);
  }

  void joint(int j) {
    const Following a(a_, j), b(b_, j);
    if (!a.known() && !b.known()) return;
    const auto add_of = [&](const char* what, const char* unit, const char* meaning,
                            double resolution, double scale, auto member) {
      const auto of = [&](const Following& following) {
        if (!following.known()) return Measured{};
        return scaled(measured([&](int without) { return (following.*member)(without); }), scale);
      };
      measures_.push_back(
          {std::string(joint_name(j)) + "." + what, unit, meaning, resolution, of(a), of(b)});
    };
    // Resolutions: a tick each of the command's time and of the posture's, or what half of the play is worth;
    // half of the gears' play of 0.4 degrees, within which an unloaded joint stays for a run where it came to
    // rest; half a code of the potentiometer (190 degrees in 1,024 codes).
    const double in_play_s = std::max(a.lag_in_play_s(), b.lag_in_play_s());
    add_of("lag", "ms", "delay of the joint behind its command", std::max(2.0, 1e3 * in_play_s),
           1e3, &Following::lag);
    if (a.known() && b.known() && in_play_s > kMaxLagInPlay_s) {
      Measure& lag = measures_.back();
      lag.a = lag.b = {};
      lag.left_out =
          "the joint moved too slowly or too little to determine the lag: "
          "half of the gear's backlash can shift the lag by " +
          (in_play_s < 1 ? std::to_string(std::lround(1e3 * in_play_s)) + " ms"
                         : "a second or more");
    }
    add_of("offset", "deg", "mean difference: joint angle minus command", 0.2, 1 / kDegree,
           &Following::offset);
    add_of("scatter", "deg",
           "root mean square of the error that remains after lag and offset are removed", 0.1,
           1 / kDegree, &Following::rest);
  }

  void supply() {
    const auto volts = [](Statistic kind) {
      return [kind](const RunTrace& trace) {
        std::vector<Point> points;
        for (const auto& posture : trace.postures)
          points.push_back({posture.time_s, posture.supply_v});
        return statistic(points, trace.duration_s, kind);
      };
    };
    // 15 mV a code.
    add("supply.mean", "V", "motors' supply at the board", 0.015, volts(Statistic::mean));
    add("supply.lowest", "V",
        "lowest supply voltage that the board reported; motor currents lower this voltage", 0.1,
        volts(Statistic::least));
  }

  void link() {
    const auto trips = [](Statistic kind) {
      return [kind](const RunTrace& trace) {
        std::vector<Point> points;
        for (const auto& exchange : trace.exchanges)
          points.push_back({exchange.time_s, exchange.round_trip_s * 1e3});
        return statistic(points, trace.duration_s, kind);
      };
    };
    add("link.round_trip", "ms", "median time from a request to its reply", 0.2,
        trips(Statistic::median));
    add("link.round_trip_p95", "ms", "95th percentile", 0.5, trips(Statistic::p95));
    add("link.rate", "1/s", "answered requests per second", 1, [](const RunTrace& trace) {
      std::vector<double> blocks(kBlocks);
      for (const auto& exchange : trace.exchanges) {
        if (exchange.time_s >= 0 && exchange.time_s <= trace.duration_s)
          ++blocks[static_cast<std::size_t>(block_of(exchange.time_s, trace.duration_s))];
      }
      return measured([&](int without) -> std::optional<double> {
        double sum = 0;
        for (int b = 0; b < kBlocks; ++b)
          if (b != without) sum += blocks[static_cast<std::size_t>(b)];
        const double share = without < 0 ? 1 : (kBlocks - 1.0) / kBlocks;
        return sum / (trace.duration_s * share);
      });
    });
    add("link.unanswered", "", "requests without reply", 0,
        [](const RunTrace& trace) { return count(trace.unanswered); });
    measures_.back().rare = true;
    add("link.damaged", "", "damaged frames", 0,
        [](const RunTrace& trace) { return count(trace.damaged); });
    measures_.back().rare = true;
    add("link.refused", "", "requests that the board refused", 0,
        [](const RunTrace& trace) { return count(trace.refused); });
  }

  void pictures() {
    const auto of = [](Statistic kind, auto value) {
      return [kind, value](const RunTrace& trace) {
        std::vector<Point> points;
        for (const auto& picture : trace.pictures)
          points.push_back({picture.exposure_s, value(picture)});
        return statistic(points, trace.duration_s, kind);
      };
    };
    const auto delay_ms = [](const RunTrace::Picture& picture) { return picture.delay_s * 1e3; };
    add("pictures.delay", "ms", "median time from exposure to the vision result", 1,
        of(Statistic::median, delay_ms));
    add("pictures.delay_p95", "ms", "95th percentile", 2, of(Statistic::p95, delay_ms));
    add("pictures.period", "ms", "mean time between two pictures", 0.5, [](const RunTrace& trace) {
      std::vector<Point> points;
      for (std::size_t i = 1; i < trace.pictures.size(); ++i)
        points.push_back({trace.pictures[i].exposure_s,
                          1e3 * (trace.pictures[i].exposure_s - trace.pictures[i - 1].exposure_s)});
      return statistic(points, trace.duration_s, Statistic::mean);
    });
    add("pictures.found", "%", "share of the pictures in which the ball was found", 2,
        of(Statistic::mean,
           [](const RunTrace::Picture& picture) { return picture.found ? 100.0 : 0.0; }));
  }

  const RunTrace &a_, &b_;
  std::vector<Measure> measures_;
};

// When the host first sent the two robots different targets.
double same_targets_until(const RunTrace& a, const RunTrace& b) {
  constexpr double kStep_s = 0.02;
  // A host in real time sends its targets somewhat earlier or later.
  constexpr double kShift_s = 0.1;
  double until = std::min(a.duration_s, b.duration_s);
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const CommandCurve one = command_curve(a, j), other = command_curve(b, j);
    if (one.angle_rad.empty() && other.angle_rad.empty()) continue;
    if (one.angle_rad.empty() || other.angle_rad.empty())
      return std::min(until, one.angle_rad.empty() ? other.start_s : one.start_s);
    for (double t = std::max(one.start_s, other.start_s); t < until; t += kStep_s) {
      double nearest = 1e9;
      for (double shift = -kShift_s; shift <= kShift_s; shift += kStep_s)
        nearest = std::min(nearest, std::abs(one.at(t) - other.at(t + shift)));
      if (nearest > kSameTarget) {
        until = t;
        break;
      }
    }
  }
  return until;
}

std::string seconds_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", value);
  return text;
}

std::string named(const std::string& behavior) {
  return behavior.empty() ? "an unnamed behavior" : behavior;
}

std::string degrees_text(double rad) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", rad / kDegree);
  return text;
}

// Angles when the first target came.
std::array<double, KZ_JOINTS> first_posture(const RunTrace& run) {
  const double start_s = run.targets.front().time_s;
  return std::ranges::min_element(run.postures, {},
                                  [start_s](const RunTrace::Posture& posture) {
                                    return std::abs(posture.time_s - start_s);
                                  })
      ->angle_rad;
}

// "the runs began in different postures (l_knee at 0.0 degrees in A, 31.2 in B, and 2 more joints)"; empty:
// in the same one, as far as joints are commanded.
std::string other_begin(const RunTrace& a, const RunTrace& b) {
  if (a.targets.empty() || b.targets.empty() || a.postures.empty() || b.postures.empty()) return {};
  std::uint32_t commanded = 0;
  for (const RunTrace* run : {&a, &b})
    for (const RunTrace::Targets& targets : run->targets) commanded |= targets.mask;
  const auto from = first_posture(a), to = first_posture(b);
  std::size_t worst = 0;
  double most = 0;
  int count = 0;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const double apart = std::abs(to[j] - from[j]);
    if (!(commanded >> j & 1) || apart <= kSameTarget) continue;
    ++count;
    if (apart > most) worst = j;
    most = std::max(most, apart);
  }
  if (count == 0) return {};
  return "the runs began in different postures (" +
         std::string(joint_name(static_cast<int>(worst))) + " at " + degrees_text(from[worst]) +
         " degrees in A, " + degrees_text(to[worst]) + " in B" +
         (count > 1 ? ", and " + counted(count - 1, "more joint") : "") + ")";
}

std::vector<std::string> notes_of(const RunTrace& a, const RunTrace& b, double same_s) {
  std::vector<std::string> notes;
  if (a.behavior != b.behavior)
    notes.push_back("different behaviors: A ran " + named(a.behavior) + ", B ran " +
                    named(b.behavior) + "; measures of different motions are not comparable");
  else if (a.settings != b.settings)
    notes.push_back("different options of " + a.behavior + ": A " + a.settings + ", B " +
                    b.settings);
  const double shorter = std::min(a.duration_s, b.duration_s);
  const std::string begin = other_begin(a, b);
  const bool at_once = same_s < 0.05;  // what would be printed as 0.0 s
  if (!begin.empty()) notes.push_back(begin + "; angles may differ for this reason");
  if (same_s < shorter && (begin.empty() || !at_once))
    notes.push_back((at_once ? std::string("the targets of A and B already differ at the start")
                             : "the targets of A and B agree within 1 degree until " +
                                   seconds_text(same_s) + " and then differ") +
                    "; different targets can cause different angles");
  for (const auto& [run, letter] : {std::pair{&a, "A"}, std::pair{&b, "B"}}) {
    if (!run->early_end.empty()) notes.push_back(std::string(letter) + ": " + run->early_end);
    for (const std::string& reason : run->shutdowns)
      notes.push_back(std::string(letter) + ": the board switched its motors off: " + reason);
  }
  return notes;
}

}  // namespace

double CommandCurve::at(double time_s) const {
  const auto i = static_cast<std::ptrdiff_t>(std::lround((time_s - start_s) / kGrid_s));
  const auto last = static_cast<std::ptrdiff_t>(angle_rad.size()) - 1;
  return angle_rad[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, last))];
}

CommandCurve command_curve(const RunTrace& trace, int joint) {
  CommandCurve curve;
  const auto j = static_cast<std::size_t>(joint);
  const auto concerned = [&](const RunTrace::Targets& targets) {
    return (targets.mask >> joint & 1) != 0;
  };
  const auto first = std::ranges::find_if(trace.targets, concerned);
  if (first == trace.targets.end()) return curve;
  curve.start_s = first->time_s;
  // Where it stood at the first command: the nearest posture.
  double from = first->angle_rad[j];
  double nearest = 1e9;
  for (const auto& posture : trace.postures) {
    const double apart = std::abs(posture.time_s - curve.start_s);
    if (apart < nearest) {
      nearest = apart;
      from = posture.angle_rad[j];
    }
  }
  // Behind the last ramp nothing changes.
  const auto last = std::ranges::find_if(trace.targets.rbegin(), trace.targets.rend(), concerned);
  const double end_s = std::min(trace.duration_s, last->time_s + last->ramp_s) + kGrid_s;
  const auto steps = static_cast<std::size_t>(std::max((end_s - curve.start_s) / kGrid_s, 1.0)) + 1;
  curve.angle_rad.reserve(steps);
  auto next = first;
  double begin_s = curve.start_s, ramp_s = 0, to = from;
  double now = from;
  for (std::size_t i = 0; i < steps; ++i) {
    const double t = curve.start_s + static_cast<double>(i) * kGrid_s;
    for (; next != trace.targets.end() && next->time_s <= t; ++next) {
      if (!concerned(*next)) continue;
      from = now;
      to = next->angle_rad[j];
      begin_s = next->time_s;
      ramp_s = next->ramp_s;
    }
    now = ramp_s <= 0 || t >= begin_s + ramp_s ? to : from + (to - from) * (t - begin_s) / ramp_s;
    curve.angle_rad.push_back(now);
  }
  return curve;
}

double Measure::threshold() const {
  // Welch and Satterthwaite: degrees of freedom of the difference of two means of unlike scatter.
  const double va = a.error * a.error, vb = b.error * b.error;
  // The difference of two counts of rare events scatters by the root of their sum; beyond 3.3 of them is
  // one normal value in a thousand.
  if (rare) return 3.3 * std::sqrt(a.value + b.value);
  if (va + vb <= 0) return resolution;
  const double freedom = (kBlocks - 1) * (va + vb) * (va + vb) / (va * va + vb * vb);
  const auto row = static_cast<std::size_t>(std::clamp(freedom, 7.0, 14.0) - 7);
  return std::max(resolution, kStudent[row] * std::sqrt(va + vb));
}

bool Measure::differs() const {
  return comparable() && std::abs(difference()) > threshold();
}

int Comparison::differing() const {
  return static_cast<int>(std::ranges::count_if(measures, &Measure::differs));
}

Comparison compare(const RunTrace& a, const RunTrace& b) {
  Comparison comparison;
  comparison.measures = Measurer(a, b).all();
  comparison.same_targets_s = same_targets_until(a, b);
  comparison.notes = notes_of(a, b, comparison.same_targets_s);
  return comparison;
}

}  // namespace kaz::tools
