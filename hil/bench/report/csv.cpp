// A report as tables of comma-separated values (RFC 4180).
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "hil/bench/report.h"
#include "hil/bench/report/numbers.h"

namespace kaz::hil {
namespace {

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string row(std::initializer_list<std::string> cells) {
  std::string text;
  for (const std::string& one : cells) {
    if (&one != cells.begin()) text += ',';
    text += cell(one);
  }
  return text + "\n";
}

// That is not there: empty.
std::string limit(double value) {
  return std::isinf(value) ? std::string() : exact_text(value);
}

}  // namespace

std::string bench_csv(const BenchReport& report) {
  std::string text =
      row({"subject", "name", "value", "error", "unit", "low", "high", "verdict", "message"});
  for (const Measurement& one : report.measurements) {
    // What was not measured has neither value nor error.
    const bool measured = one.verdict != Verdict::left_out || std::isfinite(one.value);
    text += row({one.subject, one.of->name, measured ? exact_text(one.value) : "",
                 measured && one.error != 0 ? exact_text(one.error) : "", one.of->unit,
                 limit(one.low), limit(one.high), verdict_text(one.verdict), one.message});
  }
  return text;
}

std::string bench_curves_csv(const BenchReport& report) {
  std::string text = row({"subject", "plot", "series", "x", "y"});
  for (const Plot& plot : report.plots) {
    for (const Series& series : plot.series) {
      for (const auto& [x, y] : series.points) {
        text += row({plot.subject, plot.id, series.name, exact_text(x), exact_text(y)});
      }
    }
  }
  return text;
}

}  // namespace kaz::hil
