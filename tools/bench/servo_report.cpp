// Reports a fit of a servo's model as JSON, HTML and text.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/servo_report.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "hil/report/page.h"
#include "shared/base/xml_text.hpp"
#include "shared/plot/svg.h"
#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

using hil::FittedServoParam;
using hil::GroupScore;
using hil::ServoFit;
using hil::ServoLog;
using hil::ServoScore;
using Json = nlohmann::ordered_json;

constexpr double kDegrees = 57.29577951308232, kMrad = 1e3;

std::string number(double value) {
  if (std::isnan(value)) return "-";
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string mrad(double rad) {
  return std::isnan(rad) ? "-" : hil::fixed(kMrad * rad, 1);
}

std::string within(const FittedServoParam& one) {
  return one.determined ? "+- " + number(one.determined_within) : "not determined";
}

Json errors_json(const hil::LogErrors& errors, bool current) {
  Json json{{"position_rad", errors.position_rad}};
  if (current) json["current_share"] = errors.current_share;
  return json;
}

Json fit_json(const ServoFit& fit, bool current, bool held_out) {
  Json json{{"model", fit.model}, {"error", errors_json(fit.fit, current)}};
  if (std::isfinite(fit.inner_rad)) json["inner_splits_rad"] = fit.inner_rad;
  if (held_out) json["held_out"] = errors_json(fit.held_out, current);
  if (!fit.own_zeros.empty())
    json["held_out_own_zeros"] = errors_json(fit.held_out_own_zeros, current);
  for (const FittedServoParam& one : fit.fitted) {
    auto& param = json["params"][std::string(one.of->name)];
    param = {{"unit", one.of->unit}, {"value", one.value}, {"determined", one.determined}};
    if (std::isfinite(one.determined_within)) param["within"] = one.determined_within;
  }
  for (const hil::RigZero& one : fit.zeros) {
    auto& zero = json["zeros"][one.rig];
    zero = {{"rad", one.zero_rad}, {"mean_of_fitted_rigs", one.held_out}};
    if (std::isfinite(one.determined_within)) zero["within"] = one.determined_within;
  }
  for (const hil::RigZero& one : fit.own_zeros) json["own_zeros"][one.rig]["rad"] = one.zero_rad;
  return json;
}

using Rows = std::vector<std::vector<std::string>>;

Rows model_rows(const ServoResult& result) {
  Rows rows{{"model", "position", "inner splits", "held out", "current", "held out"},
            {"", "degrees", "degrees", "degrees", "%", "%"}};
  const bool current = result.current, held_out = !result.held_out.empty();
  for (const ServoFit& fit : result.fits)
    rows.push_back({"M" + std::to_string(fit.model), number(kDegrees * fit.fit.position_rad),
                    std::isfinite(fit.inner_rad) ? number(kDegrees * fit.inner_rad) : "-",
                    held_out ? number(kDegrees * fit.held_out.position_rad) : "-",
                    current ? number(100 * fit.fit.current_share) : "-",
                    current && held_out ? number(100 * fit.held_out.current_share) : "-"});
  return rows;
}

Rows param_rows(const ServoFit& best) {
  Rows rows{{"parameter", "value", "unit", "tolerance"}};
  for (const FittedServoParam& one : best.fitted)
    rows.push_back(
        {std::string(one.of->name), number(one.value), std::string(one.of->unit), within(one)});
  for (const hil::RigZero& one : best.zeros)
    rows.push_back({"zero of " + one.rig, number(one.zero_rad), "rad",
                    one.held_out                           ? "mean of the fitted rigs"
                    : std::isfinite(one.determined_within) ? "+- " + number(one.determined_within)
                                                           : "not determined"});
  return rows;
}

Rows score_rows(const ServoScore& score) {
  Rows rows{{"group", "logs", "error", "without strays", "repeatability"},
            {"", "", "mrad", "mrad", "mrad"}};
  for (const GroupScore& one : score.groups)
    rows.push_back({one.kind == "all" ? one.name : one.kind + " " + one.name,
                    std::to_string(one.logs), mrad(one.error_rad), mrad(one.trimmed_rad),
                    mrad(one.floor_rad)});
  return rows;
}

std::string choice_sentence(const ServoResult& result) {
  std::string text = "M" + std::to_string(result.best().model) +
                     ": simplest model within 3 % of the smallest error ";
  if (!std::isfinite(result.best().inner_rad)) return text + "of the fitted logs";
  std::string names;
  for (const hil::InnerSplit& one : hil::inner_splits(result.logs))
    names += (names.empty() ? "" : " and ") + one.name;
  return text + "of the inner splits, which leave out " + names;
}

// Sentences on the quality of logs and model.
std::vector<std::string> remarks(const ServoResult& result) {
  std::vector<std::string> all;
  int volts = 0, positions = 0, currents = 0;
  for (const auto* logs : {&result.logs, &result.held_out}) {
    for (const ServoLog& log : *logs) {
      volts += log.repaired_volts;
      positions += log.repaired_positions;
      currents += static_cast<int>(log.unsigned_current);
    }
  }
  if (volts + positions > 0)
    all.push_back("impossible samples repaired: " + std::to_string(volts) + " voltages, " +
                  std::to_string(positions) + " positions");
  if (currents > 0)
    all.push_back("currents without sign, not used: " + std::to_string(currents) + " logs");
  if (!result.own_zeros_score.groups.empty())
    all.push_back("error of the held-out logs with zeros fitted to them: " +
                  mrad(result.own_zeros_score.groups[0].error_rad) + " mrad");
  all.push_back(choice_sentence(result));
  for (const hil::WrongInput& one : result.wrong)
    all.push_back("wrong input? " + hil::sentence_of(one));
  for (const std::string& name : result.score.strays)
    all.push_back(name + " ends more than 150 mrad from its repeats");
  for (const hil::ModelGap& gap : result.score.gaps)
    all.push_back("model incomplete: motion " + gap.motion + ", error " + mrad(gap.error_rad) +
                  " mrad, limit " + mrad(gap.limit_rad) + " mrad; largest error with " + gap.phase +
                  ": " + mrad(gap.phase_rad) + " mrad");
  return all;
}

std::string table_html(const Rows& rows) {
  std::string text = "<table>\n";
  for (std::size_t i = 0; i < rows.size(); ++i)
    text += hil::table_row(rows[i], i == 0 ? "th" : "td");
  return text + "</table>\n";
}

std::string table_text(const Rows& rows) {
  std::string text;
  std::vector<std::size_t> widths(rows[0].size(), 0);
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i)
      line += row[i] + std::string(widths[i] + 2 - row[i].size(), ' ');
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace

Result<void> judge_servo(ServoResult& result, const hil::ServoFitOptions& options) {
  const ServoFit& best = result.best();
  result.score = hil::score_of(best, result.held_out.empty() ? result.logs : result.held_out);
  if (!best.own_zeros.empty())
    result.own_zeros_score = hil::score_of(best.with_own_zeros(), result.held_out);
  for (const ServoLog& log : result.logs) result.current = result.current || log.has_current;
  std::vector<ServoLog> all = result.logs;
  all.insert(all.end(), result.held_out.begin(), result.held_out.end());
  result.wrong = hil::wrong_inputs(best.with_own_zeros(), all, options);
  if (options.stopped()) return fail(Fault::interrupted, "interrupted; nothing was written");
  return {};
}

Json servo_score_json(const ServoScore& score) {
  Json json;
  for (const GroupScore& one : score.groups) {
    Json group{
        {"kind", one.kind}, {"name", one.name}, {"logs", one.logs}, {"error_rad", one.error_rad}};
    if (!std::isnan(one.trimmed_rad)) group["without_strays_rad"] = one.trimmed_rad;
    if (!std::isnan(one.floor_rad)) group["repeatability_rad"] = one.floor_rad;
    json["groups"].push_back(group);
  }
  json["strays"] = score.strays;
  json["verdict"] = score.gaps.empty() ? "model complete" : "model incomplete";
  for (const hil::ModelGap& one : score.gaps)
    json["gaps"].push_back({{"motion", one.motion},
                            {"phase", one.phase},
                            {"error_rad", one.error_rad},
                            {"phase_error_rad", one.phase_rad},
                            {"limit_rad", one.limit_rad}});
  return json;
}

Json servo_json(const ServoResult& result) {
  Json json{{"chosen", result.best().model}};
  for (const auto& [key, logs] :
       {std::pair{"logs", &result.logs}, {"held_out", &result.held_out}}) {
    json[key] = Json::array();
    for (const ServoLog& log : *logs) json[key].push_back(log.name);
  }
  for (const ServoFit& fit : result.fits)
    json["models"].push_back(fit_json(fit, result.current, !result.held_out.empty()));
  json["score"] = servo_score_json(result.score);
  if (!result.own_zeros_score.groups.empty())
    json["score_own_zeros"] = servo_score_json(result.own_zeros_score);
  json["wrong_inputs"] = Json::array();
  for (const hil::WrongInput& one : result.wrong)
    json["wrong_inputs"].push_back({{"logs", one.logs},
                                    {"quantity", one.quantity},
                                    {"factor", one.factor},
                                    {"other", one.other}});
  json["remarks"] = remarks(result);
  json["provenance"] = provenance_json();
  return json;
}

plot::PlotPage servo_plot(const ServoResult& result, const ServoLog& log) {
  const ServoFit &simple = result.fits.front(), &best = result.best();
  const auto series = [&log](const char* label, plot::Color color, const std::vector<double>& y) {
    plot::Series made;
    made.label = label;
    made.color = color;
    for (std::size_t i = 0; i < log.samples.size(); ++i) {
      made.x.push_back(log.samples[i].time_s - log.samples.front().time_s);
      made.y.push_back(y[i]);
    }
    return made;
  };
  std::vector<double> goal, read, current;
  for (const hil::ServoSample& one : log.samples) {
    goal.push_back(kDegrees * one.goal_rad);
    read.push_back(kDegrees * one.position_rad);
    current.push_back(one.current_a);
  }
  auto first = simple.predict(log), second = best.predict(log);
  for (auto* made : {&first, &second})
    for (double& angle : made->position_rad) angle *= kDegrees;
  const std::string simple_name = "M" + std::to_string(simple.model),
                    name = "M" + std::to_string(best.model);
  plot::PlotPage page;
  page.title = std::filesystem::path(log.name).filename().string() + ", held out";
  page.x_label = "time, s";
  plot::LinePlot angle;
  angle.title = "Position";
  angle.y_label = "position, degrees";
  angle.series = {series("goal", plot::kGrey, goal), series("read", plot::kBlack, read),
                  series(simple_name.c_str(), plot::kOrange, first.position_rad),
                  series(name.c_str(), plot::kBlue, second.position_rad)};
  page.plots.push_back(angle);
  if (log.has_current) {
    plot::LinePlot amps;
    amps.title = "Current";
    amps.y_label = "current, A";
    amps.series = {series("read", plot::kBlack, current),
                   series(name.c_str(), plot::kBlue, second.current_a)};
    page.plots.push_back(amps);
  }
  return page;
}

std::string servo_html(const ServoResult& result, const std::vector<plot::PlotPage>& plots) {
  std::string text =
      hil::page_head("Kaz: a servo's motor and friction",
                     "figure { margin: 1em 0 } svg { max-width: 100%; height: auto }") +
      "<h1>A servo's motor and friction</h1>\n<p class=\"facts\">" +
      hil::provenance_html(provenance()) +
      "</p>\n<h2>Models</h2>\n<p>Mean errors of the predicted position (degrees) and of the "
      "predicted current (% of the measured current), for the fitted logs and for the held-out "
      "logs.</p>\n" +
      table_html(model_rows(result)) + "<h2>Parameters of M" + std::to_string(result.best().model) +
      "</h2>\n<p>Tolerance: the error grows by 3 % if the parameter changes by this amount and all "
      "others are fitted again. A parameter is not determined if its tolerance is half of its "
      "value or more.</p>\n" +
      table_html(param_rows(result.best())) + "<h2>Errors of M" +
      std::to_string(result.best().model) + " on the " +
      (result.held_out.empty() ? "fitted" : "held-out") +
      " logs</h2>\n<p>Repeatability: mean distance of each log from the median of its repeats. The "
      "model is incomplete if a motion's error is above twice the larger of repeatability and 5 "
      "mrad.</p>\n" +
      table_html(score_rows(result.score));
  for (const std::string& line : remarks(result)) text += "<p>" + xml_text(line) + "</p>\n";
  for (const plot::PlotPage& page : plots)
    text += "<figure>\n" + plot::plot_svg(page) + "</figure>\n";
  return text + hil::kPageEnd;
}

std::string servo_text(const ServoResult& result) {
  std::string text = table_text(model_rows(result)) + "\nM" + std::to_string(result.best().model) +
                     ":\n" + table_text(param_rows(result.best())) + "\n" +
                     (result.held_out.empty() ? "fitted" : "held-out") + " logs:\n" +
                     table_text(score_rows(result.score)) + "\n";
  for (const std::string& line : remarks(result)) text += line + "\n";
  return text;
}

}  // namespace kaz::tools
