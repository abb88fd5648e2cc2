// Reports of the bench: JSON, CSV, JUnit XML, and one HTML page with plots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/bench/measurement.h"
#include "shared/plot/plot.h"

namespace kaz::hil {

std::string bench_json(const BenchReport& report);
// Parses the output of bench_json(). Errors (usage): the text is not JSON, or is not the report of a bench.
Result<BenchReport> parse_bench_json(const std::string& json, const std::string& file_name);
// Returns CSV with one line per measurement: subject, name, value, error, unit, low, high, verdict, message.
std::string bench_csv(const BenchReport& report);
// Returns CSV with one line per point: subject, plot, series, x, y.
std::string bench_curves_csv(const BenchReport& report);
std::string bench_junit(const BenchReport& report);
// Returns a self-contained page, which has no script and fetches nothing.
std::string bench_html(const BenchReport& report);
// Converts a plot to a page for plot::plot_svg().
plot::PlotPage plot_page(const Plot& plot);

}  // namespace kaz::hil
