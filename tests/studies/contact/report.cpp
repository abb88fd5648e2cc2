// Markdown, JSON and CSV of the rows.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/contact/report.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "tests/studies/common/table.h"

namespace kaz::contact {
namespace {

using studies::MarkdownTable;
using studies::text;

constexpr const char* kJudge = "mujoco";  // each row's score is divided by the score of this row

const Row* judge_row(std::span<const Row> rows) {
  const auto found =
      std::ranges::find_if(rows, [](const Row& row) { return row.engine.name == kJudge; });
  return found == rows.end() ? nullptr : &*found;
}

std::string ratio_text(const Row& row, const Row* judge, std::uint64_t seed) {
  if (judge == nullptr || judge == &row) return "";
  const Interval ratio = bootstrap_ratio(row.judged.errors, judge->judged.errors, seed);
  return text("%.2f (%.2f to %.2f)", mean(row.judged.errors) / mean(judge->judged.errors),
              ratio.low, ratio.high);
}

std::string score_table(std::span<const Row> rows, std::uint64_t seed) {
  MarkdownTable table({"engine", "score", "95 %", "median", "score of the fit", "ratio to MuJoCo"});
  const Row* const judge = judge_row(rows);
  for (const Row& row : rows) {
    const Interval interval = bootstrap_mean(row.judged.errors, seed);
    table.add(
        {row.engine.name, text("%.3f", mean(row.judged.errors)),
         text("%.3f to %.3f", interval.low, interval.high), text("%.3f", median(row.judged.errors)),
         text("%.3f, %.3f", row.fits[0].score, row.fits[1].score), ratio_text(row, judge, seed)});
  }
  for (const auto& [name, score] :
       {std::pair{"Drake", 0.2702}, {"Bullet", 0.2719}, {"MuJoCo", 0.3707}})
    table.add({std::string(name) + ", published (550 tosses, not held out)", text("%.3f", score)});
  return table.text();
}

// Contribution of each phase to the score, for the tosses with the right final face; the others as a whole.
std::string origin_table(std::span<const Row> rows) {
  std::vector<std::string> heading{"engine", "wrong final face", "their part of the score"};
  for (const std::string_view phase : kPhaseNames)
    heading.push_back("other tosses: " + std::string(phase));
  MarkdownTable table(heading);
  for (const Row& row : rows) {
    const auto count = static_cast<double>(row.judged.errors.size());
    int wrong = 0;
    double part = 0;
    for (std::size_t i = 0; i < row.judged.errors.size(); ++i) {
      wrong += row.judged.wrong[i];
      part += row.judged.wrong[i] * row.judged.errors[i];
    }
    std::vector<std::string> cells{row.engine.name,
                                   text("%d of %zu", wrong, row.judged.errors.size()),
                                   text("%.3f", part / count)};
    for (const double phase : row.judged.right_phases) cells.push_back(text("%.3f", phase / count));
    table.add(std::move(cells));
  }
  return table.text();
}

std::string value_table(std::span<const Row> rows) {
  MarkdownTable table({"engine", "parameter", "bounds", "fit of fold 1", "fit of fold 2"});
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.engine.parameters.size(); ++i) {
      const Parameter& one = row.engine.parameters[i];
      table.add({row.engine.name, one.name + (one.unit.empty() ? "" : ", " + one.unit),
                 text("%g to %g", one.low, one.high), text("%.4g", row.fits[0].values[i]),
                 text("%.4g", row.fits[1].values[i])});
    }
  }
  return table.text();
}

nlohmann::ordered_json fit_json(const Engine& engine, const Fit& fit) {
  nlohmann::ordered_json values;
  for (std::size_t i = 0; i < engine.parameters.size(); ++i)
    values[engine.parameters[i].name] = fit.values[i];
  return {{"score", fit.score}, {"evaluations", fit.evaluations}, {"values", values}};
}

Result<Fit> fit_of(const nlohmann::json& from, const std::string& name, const Engine& engine) {
  Fit fit;
  const auto number = [&](const nlohmann::json& in, const std::string& key) -> Result<double> {
    if (in.is_object() && in.contains(key) && in[key].is_number()) return in[key].get<double>();
    return fail(Fault::usage, name + ": engine " + engine.name + " has no number `" + key +
                                  "` in a fit; give contact.json of this study");
  };
  fit.score = KAZ_TRY(number(from, "score"));
  const nlohmann::json values = from.value("values", nlohmann::json());
  for (const Parameter& one : engine.parameters) {
    const double value = KAZ_TRY(number(values, one.name));
    if (!(value >= one.low && value <= one.high))
      return fail(Fault::usage, name + ": " + engine.name + ": " + one.name +
                                    text(" is %g; must be %g to %g", value, one.low, one.high));
    fit.values.push_back(value);
  }
  return fit;
}

}  // namespace

std::string markdown(std::span<const Row> rows, std::uint64_t seed) {
  return score_table(rows, seed) + "\n" + origin_table(rows) + "\n" + value_table(rows);
}

std::string json(std::span<const Row> rows, std::span<const Toss> tosses, std::uint64_t seed) {
  nlohmann::ordered_json all;
  for (const Toss& toss : tosses) all["tosses"].push_back(toss.number);
  for (const Row& row : rows) {
    const Interval interval = bootstrap_mean(row.judged.errors, seed);
    nlohmann::ordered_json phases;
    for (std::size_t i = 0; i < kPhaseNames.size(); ++i)
      phases[std::string(kPhaseNames[i])] =
          row.judged.right_phases[i] / static_cast<double>(tosses.size());
    all["rows"].push_back(
        {{"engine", row.engine.name},
         {"score", mean(row.judged.errors)},
         {"interval", {interval.low, interval.high}},
         {"fits", {fit_json(row.engine, row.fits[0]), fit_json(row.engine, row.fits[1])}},
         {"phases_right_face", phases},
         {"wrong_face", row.judged.wrong},
         {"errors", row.judged.errors}});
  }
  return all.dump(1) + "\n";
}

Result<std::array<Fit, 2>> read_fits(const std::string& text, const std::string& name,
                                     const Engine& engine) {
  const auto all = parse_bounded_json<nlohmann::json>(text);
  if (!all) return fail(Fault::usage, name + ": " + all.error().message);
  const auto missing = [&] {
    return fail(Fault::usage, name + ": has no two fits of the engine " + engine.name +
                                  "; give contact.json of a run with this engine");
  };
  if (!all->is_object() || !all->contains("rows") || !(*all)["rows"].is_array()) return missing();
  for (const nlohmann::json& row : (*all)["rows"]) {
    if (!row.is_object() || row.value("engine", nlohmann::json()) != engine.name) continue;
    const nlohmann::json fits = row.value("fits", nlohmann::json());
    if (!fits.is_array() || fits.size() != 2 || !fits[0].is_object() || !fits[1].is_object())
      return missing();
    const Fit first = KAZ_TRY(fit_of(fits[0], name, engine));
    const Fit second = KAZ_TRY(fit_of(fits[1], name, engine));
    return std::array<Fit, 2>{first, second};
  }
  return missing();
}

std::string csv(std::span<const Row> rows, std::span<const Toss> tosses) {
  std::string out = "toss,fold";
  for (const Row& row : rows) out += "," + row.engine.name;
  out += "\n";
  for (std::size_t i = 0; i < tosses.size(); ++i) {
    out += text("%d,%d", tosses[i].number, fold_of(tosses[i]) + 1);
    for (const Row& row : rows) out += text(",%.4f", row.judged.errors[i]);
    out += "\n";
  }
  return out;
}

}  // namespace kaz::contact
