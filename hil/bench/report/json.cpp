// A report as JSON, and back.
// SPDX-License-Identifier: Apache-2.0
//
// JSON has no infinite numbers and no NaN: "inf" and "-inf" stand for the former, null for NaN, and
// a limit that is not there is null.
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "hil/bench/report.h"
#include "shared/base/bounded_json.hpp"
#include "shared/base/enum_names.hpp"

namespace kaz::hil {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// What is wrong with a file, for the sentence.
struct Wrong : std::runtime_error {
  using std::runtime_error::runtime_error;
};

Json number(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json limit(double value, double none) {
  return value == none ? Json(nullptr) : number(value);
}

double to_number(const Json& json, double null = kNone) {
  if (json.is_null()) return null;
  if (json == "inf") return kInfinite;
  if (json == "-inf") return -kInfinite;
  return json.get<double>();
}

Json to_json(const Measurement& one) {
  Json json;
  json["subject"] = one.subject;
  json["name"] = one.of->name;
  json["unit"] = one.of->unit;
  json["verdict"] = verdict_text(one.verdict);
  // What was not measured has neither.
  const bool measured = one.verdict != Verdict::left_out || std::isfinite(one.value);
  json["value"] = measured ? number(one.value) : Json(nullptr);
  json["error"] = measured && one.error != 0 ? number(one.error) : Json(nullptr);
  json["low"] = limit(one.low, -kInfinite);
  json["high"] = limit(one.high, kInfinite);
  json["message"] = one.message;
  return json;
}

Verdict to_verdict(const std::string& text) {
  for (const Verdict verdict :
       {Verdict::passed, Verdict::failed, Verdict::left_out, Verdict::undecided}) {
    if (text == verdict_text(verdict)) return verdict;
  }
  throw Wrong("unknown verdict '" + text + "'");
}

Measurement to_measurement(const Json& json) {
  Measurement one;
  const std::string name = json.at("name");
  one.of = find_measurement(name);
  if (!one.of) throw Wrong("unknown measurement '" + name + "'");
  if (json.at("unit") != one.of->unit) throw Wrong("'" + name + "' has the wrong unit");
  one.subject = json.at("subject");
  one.verdict = to_verdict(json.at("verdict"));
  one.value = to_number(json.at("value"));
  one.error = to_number(json.at("error"), 0);
  one.low = to_number(json.at("low"), -kInfinite);
  one.high = to_number(json.at("high"), kInfinite);
  one.message = json.at("message");
  return one;
}

Json to_json(const Plot& plot) {
  Json json;
  json["id"] = plot.id;
  json["subject"] = plot.subject;
  json["title"] = plot.title;
  json["x_label"] = plot.x_label;
  json["y_label"] = plot.y_label;
  json["x_logarithmic"] = plot.x_logarithmic;
  json["caption"] = plot.caption;
  json["series"] = Json::array();
  for (const Series& series : plot.series) {
    Json points = Json::array();
    for (const auto& [x, y] : series.points) points.push_back({number(x), number(y)});
    json["series"].push_back(
        {{"name", series.name}, {"style", to_string(series.style)}, {"points", std::move(points)}});
  }
  return json;
}

Series to_series(const Json& json) {
  Series series;
  series.name = json.at("name");
  const std::string name = json.at("style");
  const auto style = parse_enum(plot::kStyles, name);
  if (!style) throw Wrong("unknown style '" + name + "'");
  series.style = *style;
  for (const Json& point : json.at("points")) {
    series.points.emplace_back(to_number(point.at(0)), to_number(point.at(1)));
  }
  return series;
}

Plot to_plot(const Json& json) {
  Plot plot;
  plot.id = json.at("id");
  plot.subject = json.at("subject");
  plot.title = json.at("title");
  plot.x_label = json.at("x_label");
  plot.y_label = json.at("y_label");
  plot.x_logarithmic = json.at("x_logarithmic");
  plot.caption = json.at("caption");
  for (const Json& series : json.at("series")) plot.series.push_back(to_series(series));
  return plot;
}

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// An entry a line: points in lines of their own would make long files longer.
template <class List, class Convert>
std::string list_text(const char* name, const List& list, Convert convert) {
  std::string text = "  \"" + std::string(name) + "\": [";
  for (std::size_t i = 0; i < list.size(); ++i) {
    text += (i == 0 ? "\n    " : ",\n    ") + dumped(convert(list[i]));
  }
  return text + (list.empty() ? "]" : "\n  ]");
}

// None: measured at a port.
std::optional<std::uint64_t> to_seed(const Json& all) {
  const auto seed = all.find("seed");
  if (seed == all.end()) return std::nullopt;
  if (!seed->is_number_unsigned())  // larger ones are fractions to the parser
    throw Wrong("its seed must be a 64-bit unsigned integer");
  return seed->get<std::uint64_t>();
}

BenchReport to_report(const Json& all) {
  BenchReport report;
  report.board = all.at("board");
  report.port = all.at("port");
  report.program = all.at("program");
  report.seed = to_seed(all);
  report.seconds = to_number(all.at("seconds"));
  // Older reports have the reason as `interrupted`.
  const char* const reason =
      all.contains("interrupted") && all["interrupted"].is_string() ? "interrupted" : "ended_early";
  report.interrupted = all.value(reason, "");
  report.signal = all.value("signal", "");
  for (const Json& one : all.at("conditions")) {
    report.conditions.emplace_back(one.at("name"), to_number(one.at("value")));
  }
  for (const Json& one : all.at("measurements")) {
    report.measurements.push_back(to_measurement(one));
  }
  for (const Json& one : all.at("plots")) report.plots.push_back(to_plot(one));
  return report;
}

}  // namespace

std::string bench_json(const BenchReport& report) {
  std::string text = "{\n";
  const auto entry = [&](const char* name, const Json& value) {
    text += "  \"" + std::string(name) + "\": " + dumped(value) + ",\n";
  };
  entry("board", report.board);
  entry("port", report.port);
  entry("program", report.program);
  if (report.seed) entry("seed", *report.seed);
  entry("provenance", provenance_json(report.from));
  entry("seconds", number(report.seconds));
  if (!report.signal.empty()) {
    entry("interrupted", true);
    entry("signal", report.signal);
  }
  if (!report.interrupted.empty()) entry("ended_early", report.interrupted);
  entry("passed", report.count(Verdict::passed));
  entry("failed", report.count(Verdict::failed));
  entry("left_out", report.count(Verdict::left_out));
  entry("undecided", report.count(Verdict::undecided));
  text += list_text("conditions", report.conditions, [](const auto& condition) {
    return Json{{"name", condition.first}, {"value", number(condition.second)}};
  });
  text += ",\n" + list_text("measurements", report.measurements,
                            [](const Measurement& one) { return to_json(one); });
  text += ",\n" + list_text("plots", report.plots, [](const Plot& plot) { return to_json(plot); });
  return text + "\n}\n";
}

Result<BenchReport> parse_bench_json(const std::string& json, const std::string& file_name) {
  std::string why = "it is not valid JSON";
  try {
    const auto all = parse_bounded_json<Json>(json);
    if (!all) throw Wrong(all.error().message);
    why = "it was not written by kaz bench";
    return to_report(*all);
  } catch (const Wrong& wrong) {
    why = wrong.what();
  } catch (const Json::exception&) {
  }
  return fail(Fault::usage, "'" + file_name + "' is not a report of kaz bench: " + why);
}

}  // namespace kaz::hil
