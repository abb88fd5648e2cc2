// From a bench's report to the parameters of the motor model.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/motor_fit.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "host/robot/posture.h"
#include "shared/base/angle.hpp"
#include "tools/lockstep/stand_backend.h"

namespace kaz::lockstep {
namespace {

using sim::MotorParams;
using Values = std::map<std::string, double>;  // by measurement; only those that are numbers

constexpr int kSeeds = 2;          // of the simulated bench in each round
constexpr int kRough = 3;          // rounds that come near, before the fine ones
constexpr double kSettled = 2e-3;  // relative change of every parameter
constexpr double kMaxFactor = 3;   // that a round may change a parameter by
const std::vector<std::string> kCurves = {"stall", "no_load", "start", "step", "thermal", "gain"};

Values values_of(const hil::BenchReport& report, const std::string& joint) {
  Values values;
  for (const hil::Measurement& one : report.measurements) {
    if (one.subject == joint && std::isfinite(one.value)) values[one.of->name] = one.value;
  }
  return values;
}

// The rougher measurement of friction in place of the sharper one, in motor and model alike.
void take_sliding(Values& values) {
  if (const auto sliding = values.find("friction.sliding"); sliding != values.end())
    values["friction.running"] = sliding->second;
}

// A parameter, the measurements it takes, and its estimate by formula.
struct Estimator {
  const char* name;
  const char* unit;
  double MotorParams::*param;
  std::vector<std::string> needs;
  double (*estimate)(const Values&, double disc_kgm2);
};

// start.time_constant = (rotor + disc) / back_emf, and what gap and tick add, which is corrected.
const std::vector<Estimator>& estimators() {
  static const std::vector<Estimator> all = {
      {"stall_slope",
       "Nm/V",
       &MotorParams::stall_slope_nm_per_v,
       {"stall.slope"},
       [](const Values& v, double) { return v.at("stall.slope"); }},
      {"friction",
       "Nm",
       &MotorParams::friction_nm,
       {"friction.running"},
       [](const Values& v, double) { return v.at("friction.running"); }},
      {"back_emf",
       "Nm s/rad",
       &MotorParams::back_emf_nms_per_rad,
       {"stall.slope", "no_load.slope"},
       [](const Values& v, double) { return v.at("stall.slope") / v.at("no_load.slope"); }},
      {"stiction_ratio",
       "",
       &MotorParams::stiction_ratio,
       {"friction.breakaway", "friction.running"},
       [](const Values& v, double) {
         return v.at("friction.breakaway") / v.at("friction.running");
       }},
      {"rotor_inertia",
       "kg m2",
       &MotorParams::rotor_inertia_kgm2,
       {"start.time_constant", "stall.slope", "no_load.slope"},
       [](const Values& v, double) {
         return 1e-3 * v.at("start.time_constant") * v.at("stall.slope") / v.at("no_load.slope");
       }},
      {"backlash",
       "rad",
       &MotorParams::backlash_rad,
       {"backlash"},
       [](const Values& v, double) { return v.at("backlash") * kDegree; }},
      {"winding_heat_capacity",
       "J/K",
       &MotorParams::winding_heat_capacity,
       {"thermal.torque_loss"},
       [](const Values& v, double) { return 1 / v.at("thermal.torque_loss"); }},
  };
  return all;
}

bool has_all(const Estimator& estimator, const Values& values) {
  return std::ranges::all_of(estimator.needs, [&](const std::string& name) {
    const auto found = values.find(name);
    return found != values.end() && found->second > 0;
  });
}

struct Bench {
  int joint = 0;
  double disc_kgm2 = 0, supply_volts = 0, pressing_s = 0.1;
  bool running = true;  // friction.running was measured; else friction.sliding is used
  sim::SimulationOptions board;
};

Result<hil::BenchReport> simulate(const Bench& bench, const MotorParams& motor,
                                  std::uint64_t seed) {
  sim::SimulationOptions board = bench.board;
  board.seed = seed;
  auto simulation =
      sim::make_stand(board, {.motor = motor, .disc_kgm2 = bench.disc_kgm2, .seed = seed});
  if (!simulation) return tl::unexpected(simulation.error());
  StandBackend backend(std::move(*simulation), bench.pressing_s);
  hil::BenchReport report;
  const hil::Limits limits;
  hil::BenchJudge judge(report, limits);
  hil::MotorBenchOptions options;
  options.joint = bench.joint;
  options.supply_volts = bench.supply_volts;
  KAZ_TRY(backend.run(options, judge));
  return report;
}

struct Model {
  Values values;            // means over the seeds
  hil::BenchReport report;  // of the first
};

// One thread for each seed; what comes out does not depend on which is the first.
Result<Model> run_model(const Bench& bench, const MotorParams& motor) {
  std::vector<std::future<Result<hil::BenchReport>>> runs;
  for (std::uint64_t i = 0; i < kSeeds; ++i) {
    runs.push_back(std::async(std::launch::async, [&bench, &motor, i] {
      return simulate(bench, motor, bench.board.seed + 1000 + i);
    }));
  }
  Model model;
  std::optional<Error> error;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    auto report = runs[i].get();
    if (!report) {
      error = report.error();
      continue;
    }
    const std::string joint = host::joint_table()[static_cast<std::size_t>(bench.joint)].name;
    for (const auto& [name, value] : values_of(*report, joint))
      model.values[name] += value / kSeeds;
    if (i == 0) model.report = std::move(*report);
  }
  if (error) return tl::unexpected(*error);
  if (!bench.running) take_sliding(model.values);
  return model;
}

void halve_the_way(MotorParams& motor, const MotorParams& last) {
  for (const Estimator& estimator : estimators())
    motor.*estimator.param = 0.5 * (motor.*estimator.param + last.*estimator.param);
}

// Returns the largest relative change. Inertia of rotor and disc together are what a start shows.
double correct(MotorParams& motor, const Values& measured, const Values& model, double disc) {
  double largest = 0;
  for (const Estimator& estimator : estimators()) {
    if (!has_all(estimator, measured) || !has_all(estimator, model)) continue;
    const bool with_disc = estimator.param == &MotorParams::rotor_inertia_kgm2;
    const double more = with_disc ? disc : 0;
    const double ratio =
        std::clamp(estimator.estimate(measured, disc) / estimator.estimate(model, disc),
                   1 / kMaxFactor, kMaxFactor);
    const double before = motor.*estimator.param;
    double after = (before + more) * ratio - more;
    if (estimator.param == &MotorParams::stiction_ratio) after = std::max(after, 1.0);
    if (with_disc) after = std::max(after, 0.01 * disc);
    motor.*estimator.param = after;
    largest = std::max(largest, std::abs(after / before - 1));
  }
  return largest;
}

const hil::Plot* find_plot(const hil::BenchReport& report, const std::string& joint,
                           const std::string& id) {
  for (const hil::Plot& plot : report.plots) {
    if (plot.subject == joint && plot.id == id) return &plot;
  }
  return nullptr;
}

// A series at x, linear between its points; NaN outside.
double at(const hil::Series& series, double x) {
  auto points = series.points;
  std::ranges::stable_sort(points, {}, &std::pair<double, double>::first);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto& [x0, y0] = points[i - 1];
    const auto& [x1, y1] = points[i];
    if (x < x0 || x > x1) continue;
    return x1 > x0 ? y0 + (y1 - y0) * (x - x0) / (x1 - x0) : 0.5 * (y0 + y1);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Root mean square of the difference of two series, over the points of the first within the second.
double difference(const hil::Series& measured, const hil::Series& model) {
  double squares = 0;
  int count = 0;
  for (const auto& [x, y] : measured.points) {
    const double there = at(model, x);
    if (!std::isfinite(there)) continue;
    squares += (y - there) * (y - there);
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : std::numeric_limits<double>::quiet_NaN();
}

std::string unit_of(const std::string& label) {
  const auto comma = label.rfind(", ");
  return comma == std::string::npos ? "" : label.substr(comma + 2);
}

void compare_curve(MotorFit& fit, const hil::Plot& measured, const hil::Plot& before,
                   const hil::Plot& after) {
  const hil::Series& curve = measured.series.front();
  fit.gaps.push_back({"curve of " + measured.id, unit_of(measured.y_label),
                      std::numeric_limits<double>::quiet_NaN(),
                      difference(curve, before.series.front()),
                      difference(curve, after.series.front())});
  hil::Plot plot = measured;
  plot.series = {curve, before.series.front(), after.series.front()};
  const char* names[] = {"measured", "model before", "model after"};
  const hil::Series::Style styles[] = {hil::Series::Style::points, hil::Series::Style::dashed,
                                       hil::Series::Style::line};
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    plot.series[i].name = names[i];
    plot.series[i].style = styles[i];
    std::ranges::stable_sort(plot.series[i].points, {}, &std::pair<double, double>::first);
  }
  plot.caption =
      "Measured values, values of the model before the fit, and values of the model after the fit.";
  fit.plots.push_back(std::move(plot));
}

void compare(MotorFit& fit, const hil::BenchReport& measured, const std::string& joint,
             const Model& before, const Model& after) {
  for (const auto& info : hil::measurement_infos()) {
    const Values values = values_of(measured, joint);
    const auto found = values.find(info.name);
    const auto was = before.values.find(info.name), is = after.values.find(info.name);
    if (found == values.end() || was == before.values.end() || is == after.values.end()) continue;
    fit.gaps.push_back({info.name, info.unit, found->second, was->second, is->second});
  }
  for (const std::string& id : kCurves) {
    const hil::Plot* curve = find_plot(measured, joint, id);
    const hil::Plot* was = find_plot(before.report, joint, id);
    const hil::Plot* is = find_plot(after.report, joint, id);
    if (curve && was && is && !curve->series.empty()) compare_curve(fit, *curve, *was, *is);
  }
}

Result<std::string> joint_of(const hil::BenchReport& report, const std::string& wanted) {
  std::set<std::string> joints;
  for (const hil::Measurement& one : report.measurements) {
    if (one.of->group == hil::BenchGroup::motor) joints.insert(one.subject);
  }
  if (joints.empty())
    return fail(
        Fault::usage,
        "the report contains no measurements of a motor: give a report of `kaz bench motor`");
  if (wanted.empty() && joints.size() > 1)
    return fail(Fault::usage, "the report contains several joints; select one with --joint");
  const std::string joint = wanted.empty() ? *joints.begin() : wanted;
  if (!joints.contains(joint) || !host::joint_index(joint))
    return fail(Fault::usage, "the report does not contain joint `" + joint + "`");
  return joint;
}

Result<Bench> bench_of(const hil::BenchReport& report, const std::string& joint,
                       const sim::SimulationOptions& board) {
  Bench bench;
  bench.joint = *host::joint_index(joint);
  bench.board = board;
  for (const auto& [name, value] : report.conditions) {
    if (name == "disc_kgm2") bench.disc_kgm2 = value;
    if (name == "supply_volts") bench.supply_volts = value;
    if (name == "pressing_s") bench.pressing_s = value;
  }
  // Beyond these there is no bench, and the model would press for ever or not at all.
  if (bench.disc_kgm2 > 1 || bench.supply_volts > 100 ||
      !(bench.pressing_s >= 0.01 && bench.pressing_s <= 60))
    return fail(
        Fault::usage,
        "the report's conditions are out of range: disc_kgm2 must be at most 1, supply_volts "
        "at most 100, and pressing_s 0.01 to 60; measure again with `kaz bench motor`");
  if (!(bench.disc_kgm2 > 0) || !(bench.supply_volts > 0))
    return fail(
        Fault::usage,
        "the report lacks the disc's inertia or the supply voltage; a fit needs a report made with "
        "a motor stand (--stand)");
  return bench;
}

}  // namespace

Result<MotorFit> fit_motor(const hil::BenchReport& measured, const MotorFitOptions& options) {
  const auto joint = KAZ_TRY(joint_of(measured, options.joint));
  auto bench = KAZ_TRY(bench_of(measured, joint, options.board));
  Values values = values_of(measured, joint);
  bench.running = values.contains("friction.running");
  if (!bench.running) take_sliding(values);
  MotorFit fit;
  fit.motor = options.start;
  bool any = false;
  for (const Estimator& estimator : estimators()) any |= has_all(estimator, values);
  if (!any)
    return fail(
        Fault::usage,
        "the report of " + joint +
            " determines no parameter of the motor: its measurements were skipped or failed");
  const auto report_progress = [&](int done) {
    if (options.progress)
      options.progress(static_cast<double>(done) / (options.max_rounds + 1),
                       "running the bench on the model, round " + std::to_string(done + 1));
  };
  report_progress(0);
  const auto before = KAZ_TRY(run_model(bench, fit.motor));
  Model model = before;
  MotorParams last = fit.motor;
  while (fit.rounds < options.max_rounds) {
    fit.last_change = correct(fit.motor, values, model.values, bench.disc_kgm2);
    // Late rounds differ by the model's own noise: their middle is better than either.
    const MotorParams corrected = fit.motor;
    if (fit.rounds >= kRough) halve_the_way(fit.motor, last);
    last = corrected;
    report_progress(++fit.rounds);
    auto next = KAZ_TRY(run_model(bench, fit.motor));
    model = std::move(next);
    if (fit.last_change < kSettled) break;
  }
  for (const Estimator& estimator : estimators()) {
    fit.params.push_back({estimator.name, estimator.unit, options.start.*estimator.param,
                          fit.motor.*estimator.param, has_all(estimator, values)});
  }
  fit.motor.name = options.start.name + "-fitted";
  compare(fit, measured, joint, before, model);
  if (options.progress) options.progress(1, "done");  // mostly before max_rounds
  return fit;
}

}  // namespace kaz::lockstep
