// A bench's report for machines and people: JSON, CSV, JUnit XML, one HTML page with its plots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/bench/measurement.h"
#include "shared/plot/plot.h"

namespace kaz::hil {

std::string bench_json(const BenchReport& report);
// Back from bench_json(). Errors (usage): no JSON, or not one of these.
Result<BenchReport> parse_bench_json(const std::string& json, const std::string& file_name);
// A line a measurement: subject, name, value, error, unit, low, high, verdict, message.
std::string bench_csv(const BenchReport& report);
// A line a point: subject, plot, series, x, y.
std::string bench_curves_csv(const BenchReport& report);
std::string bench_junit(const BenchReport& report);
// Self-contained: no script, nothing fetched.
std::string bench_html(const BenchReport& report);
// One plot as a page, to be drawn by plot::plot_svg().
plot::PlotPage plot_page(const Plot& plot);

}  // namespace kaz::hil
