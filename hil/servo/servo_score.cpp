// Scores a servo's model by logs: error by motion, gain, mass and arm, beside the repeatability of the logs.
// SPDX-License-Identifier: Apache-2.0
#include "hil/servo/servo_score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>
#include <tuple>

namespace kaz::hil {
namespace {

constexpr double kStray = 0.15;  // rad
constexpr double kLeastFloor =
    5e-3;  // rad: a servo's backlash and resolution; no model has to be better
constexpr double kSameGoal = 0.01;  // rad: mean distance of the goals of two repeats
constexpr double kMovesRad = 0.02, kMovesSeconds = 0.2;

enum Phase { torque_off, moving_goal, resting_goal, phases };
constexpr std::array kPhaseNames{"torque off", "moving goal", "resting goal"};

struct Sum {
  double sum = 0, count = 0;
  void add(double value, double times = 1) {
    sum += value;
    count += times;
  }
  double mean() const { return sum / count; }  // NaN if nothing was added
};

// Value of a log's column at each time of `times`, linearly interpolated from the log's start.
std::vector<double> column_at(const ServoLog& log, double ServoSample::*column,
                              const std::vector<double>& times) {
  std::vector<double> values;
  std::size_t i = 0;
  for (const double time : times) {
    const double t = time + log.samples[0].time_s;
    while (i + 2 < log.samples.size() && log.samples[i + 1].time_s < t) ++i;
    const ServoSample &a = log.samples[i], &b = log.samples[i + 1];
    const double share = std::clamp((t - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0);
    values.push_back(a.*column + share * (b.*column - a.*column));
  }
  return values;
}

std::vector<double> times_of(const ServoLog& log) {
  std::vector<double> times;
  for (const ServoSample& one : log.samples) times.push_back(one.time_s - log.samples[0].time_s);
  return times;
}

bool same_setting(const ServoLog& a, const ServoLog& b) {
  if (a.rig() != b.rig() || a.motion != b.motion || a.gain_per_rad != b.gain_per_rad) return false;
  const std::vector<double> times = times_of(a);
  const auto first = column_at(a, &ServoSample::goal_rad, times),
             second = column_at(b, &ServoSample::goal_rad, times);
  Sum distance;
  for (std::size_t i = 0; i < times.size(); ++i) distance.add(std::abs(first[i] - second[i]));
  return distance.mean() < kSameGoal;
}

double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

struct LogScore {
  Sum error, floor;
  std::array<Sum, phases> by_phase;
  bool stray = false;
};

// Distances of repeats from their median, and strays.
void compare_repeats(const std::vector<ServoLog>& logs, const std::vector<std::size_t>& group,
                     std::vector<LogScore>& scores) {
  if (group.size() < 2) return;
  const std::vector<double> times = times_of(logs[group[0]]);
  std::vector<std::vector<double>> positions;
  for (const std::size_t i : group)
    positions.push_back(column_at(logs[i], &ServoSample::position_rad, times));
  for (std::size_t k = 0; k < times.size(); ++k) {
    std::vector<double> now;
    for (const auto& one : positions) now.push_back(one[k]);
    const double middle = median_of(now);
    for (std::size_t j = 0; j < group.size(); ++j)
      scores[group[j]].floor.add(std::abs(now[j] - middle));
  }
  if (group.size() < 3) return;  // of two logs that differ, neither is the stray one
  std::vector<double> ends;
  for (const auto& one : positions) ends.push_back(one.back());
  for (std::size_t j = 0; j < group.size(); ++j)
    scores[group[j]].stray = std::abs(ends[j] - median_of(ends)) > kStray;
}

Phase phase_of(const ServoLog& log, std::size_t i) {
  const std::vector<ServoSample>& samples = log.samples;
  if (!samples[i].torque_on) return torque_off;
  for (std::size_t k = i; samples[i].time_s - samples[k].time_s < kMovesSeconds; --k) {
    if (std::abs(samples[k].goal_rad - samples[i].goal_rad) > kMovesRad) return moving_goal;
    if (k == 0) break;
  }
  return resting_goal;
}

void compare_prediction(const ServoFit& fit, const ServoLog& log, LogScore& score) {
  const Prediction made = fit.predict(log);
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const double error = std::abs(made.position_rad[i] - log.samples[i].position_rad);
    score.error.add(error);
    score.by_phase[phase_of(log, i)].add(error);
  }
}

std::string label(const char* form, double value) {
  char text[40];
  std::snprintf(text, sizeof text, form, value);
  return text;
}

struct Group {
  std::string kind, name;
  double order = 0;  // groups of one kind are sorted by this number, then by name
  Sum error = {}, trimmed = {}, floor = {};
  std::array<Sum, phases> by_phase = {};
  std::size_t logs = 0;
};

void add(std::vector<Group>& groups, Group key, const LogScore& score) {
  auto at = std::ranges::find_if(
      groups, [&](const Group& one) { return one.kind == key.kind && one.name == key.name; });
  if (at == groups.end()) at = groups.insert(at, std::move(key));
  ++at->logs;
  at->error.add(score.error.sum, score.error.count);
  if (!score.stray) at->trimmed.add(score.error.sum, score.error.count);
  at->floor.add(score.floor.sum, score.floor.count);
  for (std::size_t i = 0; i < score.by_phase.size(); ++i)
    at->by_phase[i].add(score.by_phase[i].sum, score.by_phase[i].count);
}

std::optional<ModelGap> gap_of(const Group& motion) {
  const double floor = motion.floor.count > 0 ? motion.floor.mean() : 0;
  ModelGap gap{motion.name, "", motion.error.mean(), 0, 2 * std::max(kLeastFloor, floor)};
  if (gap.error_rad <= gap.limit_rad) return std::nullopt;
  for (std::size_t i = 0; i < motion.by_phase.size(); ++i) {
    if (!(motion.by_phase[i].mean() > gap.phase_rad)) continue;
    gap.phase_rad = motion.by_phase[i].mean();
    gap.phase = kPhaseNames[i];
  }
  return gap;
}

}  // namespace

std::vector<std::vector<std::size_t>> repeats_of(const std::vector<ServoLog>& logs) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const auto at = std::ranges::find_if(
        groups, [&](const auto& group) { return same_setting(logs[group[0]], logs[i]); });
    if (at == groups.end())
      groups.push_back({i});
    else
      at->push_back(i);
  }
  return groups;
}

ServoScore score_of(const ServoFit& fit, const std::vector<ServoLog>& logs) {
  std::vector<LogScore> scores(logs.size());
  for (const auto& group : repeats_of(logs)) compare_repeats(logs, group, scores);
  ServoScore result;
  std::vector<Group> groups;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const ServoLog& log = logs[i];
    compare_prediction(fit, log, scores[i]);
    if (scores[i].stray) result.strays.push_back(log.name);
    add(groups, {"all", "all logs"}, scores[i]);
    add(groups, {"motion", log.motion}, scores[i]);
    add(groups, {"gain", label("%.3g per rad", log.gain_per_rad), log.gain_per_rad}, scores[i]);
    add(groups, {"mass", label("%.4g kg", log.mass_kg), log.mass_kg}, scores[i]);
    add(groups, {"arm", label("%.4g m", log.length_m), log.length_m}, scores[i]);
  }
  const auto rank = [](const Group& one) {
    return std::string_view("all motion gain mass arm").find(one.kind);
  };
  std::ranges::sort(groups, [&](const Group& a, const Group& b) {
    return std::tuple(rank(a), a.order, a.name) < std::tuple(rank(b), b.order, b.name);
  });
  for (const Group& one : groups) {
    result.groups.push_back(
        {one.kind, one.name, one.logs, one.error.mean(), one.trimmed.mean(), one.floor.mean()});
    const auto gap = one.kind == "motion" ? gap_of(one) : std::nullopt;
    if (gap) result.gaps.push_back(*gap);
  }
  return result;
}

}  // namespace kaz::hil
