// Fits the friction models to a servo's logs, and reports.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/servo_run.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "hil/report/page.h"
#include "hil/servo/servo_fit.h"
#include "host/link/interrupt.h"
#include "shared/base/files.hpp"
#include "shared/base/xml_text.hpp"
#include "shared/plot/svg.h"
#include "tools/base/interrupt_signals.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/provenance.h"

namespace kaz::tools {
namespace {

using hil::FittedServoParam;
using hil::ServoFit;
using hil::ServoLog;
using Json = nlohmann::ordered_json;

constexpr double kDegrees = 57.29577951308232;

const OutputKind& servo_output() {
  static const OutputKind kind{"bench servo", {"report.html", "result.json", "held-out-*.svg"}};
  return kind;
}

Result<std::vector<ServoLog>> read_logs(const std::vector<std::string>& paths) {
  std::vector<ServoLog> logs;
  for (const std::string& path : paths) {
    const auto text =
        KAZ_TRY(read_whole_file(path, 64 << 20, "give a servo's log (docs/howto/bench.md)"));
    logs.push_back(KAZ_TRY(hil::parse_servo_log(text, path)));
  }
  return logs;
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
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
  if (held_out) json["held_out"] = errors_json(fit.held_out, current);
  for (const FittedServoParam& one : fit.fitted) {
    auto& param = json["params"][std::string(one.of->name)];
    param = {{"unit", one.of->unit}, {"value", one.value}, {"determined", one.determined}};
    if (std::isfinite(one.determined_within)) param["within"] = one.determined_within;
  }
  return json;
}

// The model that predicts best what it has not seen; of equals (3 %) the one with fewer parameters.
const ServoFit& chosen(const std::vector<ServoFit>& fits, bool held_out) {
  const auto error = [held_out](const ServoFit& fit) {
    return held_out ? fit.held_out.position_rad : fit.fit.position_rad;
  };
  double least = error(fits.front());
  for (const ServoFit& fit : fits) least = std::min(least, error(fit));
  for (const ServoFit& fit : fits) {
    if (error(fit) <= 1.03 * least) return fit;
  }
  return fits.front();
}

struct Report {
  std::vector<std::vector<std::string>> models, params;
};

Report report_of(const std::vector<ServoFit>& fits, const ServoFit& best, bool current,
                 bool held_out) {
  Report report;
  const auto percent = [](double share) { return number(100 * share); };
  for (const ServoFit& fit : fits)
    report.models.push_back({"M" + std::to_string(fit.model),
                             number(kDegrees * fit.fit.position_rad),
                             held_out ? number(kDegrees * fit.held_out.position_rad) : "-",
                             current ? percent(fit.fit.current_share) : "-",
                             current && held_out ? percent(fit.held_out.current_share) : "-"});
  for (const FittedServoParam& one : best.fitted)
    report.params.push_back(
        {std::string(one.of->name), std::string(one.of->unit), number(one.value), within(one)});
  return report;
}

plot::PlotPage page_of(const ServoLog& log, const ServoFit& simple, const ServoFit& best) {
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
  auto first = hil::predict(simple.model, simple.params, log);
  auto second = hil::predict(best.model, best.params, log);
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

std::string html(const Report& report, const ServoFit& best,
                 const std::vector<plot::PlotPage>& plots) {
  std::string text =
      hil::page_head("Kaz: a servo's motor and friction",
                     "figure { margin: 1em 0 } svg { max-width: 100%; height: auto }") +
      "<h1>A servo's motor and friction</h1>\n<p class=\"facts\">" +
      hil::provenance_html(provenance()) +
      "</p>\n<h2>Models</h2>\n<p>Mean errors of the predicted position (degrees) and of the "
      "predicted current (% of the measured current), for the fitted logs and for the held-out "
      "logs."
      "</p>\n<table><tr><th>model</th><th>position</th><th>held out</th><th>current</th>"
      "<th>held out</th></tr>\n";
  for (const auto& row : report.models) text += hil::table_row(row);
  text += "</table>\n<h2>Parameters of M" + std::to_string(best.model) +
          "</h2>\n"
          "<p>Tolerance: the error grows by 3 % if the parameter changes by this amount and all "
          "others are fitted again. A parameter is not determined if its tolerance is half of its "
          "value or more.</p>\n"
          "<table><tr><th>parameter</th><th>unit</th><th>value</th><th>tolerance</th></tr>\n";
  for (const auto& row : report.params) text += hil::table_row(row);
  text += "</table>\n";
  for (const plot::PlotPage& page : plots)
    text += "<figure>\n" + plot::plot_svg(page) + "</figure>\n";
  return text + hil::kPageEnd;
}

void print(const Report& report, const ServoFit& best, const std::string& where) {
  std::printf("%-6s %12s %12s %12s %12s\n", "model", "position", "held out", "current", "held out");
  std::printf("%-6s %12s %12s %12s %12s\n", "", "degrees", "degrees", "%", "%");
  for (const auto& row : report.models)
    std::printf("%-6s %12s %12s %12s %12s\n", row[0].c_str(), row[1].c_str(), row[2].c_str(),
                row[3].c_str(), row[4].c_str());
  std::printf("\nM%d:\n", best.model);
  for (const auto& row : report.params)
    std::printf("  %-18s %12s %-10s %s\n", row[0].c_str(), row[2].c_str(), row[1].c_str(),
                row[3].c_str());
  std::printf("the report is %s\n", where.c_str());
}

}  // namespace

Result<bool> run_servo_fit(const ServoFitArguments& arguments) {
  const auto logs = KAZ_TRY(read_logs(arguments.logs));
  const auto held_out = KAZ_TRY(read_logs(arguments.held_out));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto folder = KAZ_TRY(OutputFolder::open(arguments.out, servo_output()));
  Progress progress("kaz bench servo", arguments.json);
  hil::ServoFitOptions options;
  if (arguments.model > 0) options.models.resize(static_cast<std::size_t>(arguments.model));
  options.progress = [&](double share, const std::string& what) { progress.update(share, what); };
  options.stopped = [&] { return interrupt.requested(); };
  const auto fitted = hil::fit_servo(logs, held_out, options);
  progress.done();
  const auto fits = KAZ_TRY(fitted);
  bool current = false;
  for (const ServoLog& log : logs) current = current || log.has_current;
  const ServoFit& best = chosen(fits, !held_out.empty());
  const Report report = report_of(fits, best, current, !held_out.empty());
  Json result{{"chosen", best.model}, {"logs", arguments.logs}, {"held_out", arguments.held_out}};
  for (const ServoFit& fit : fits)
    result["models"].push_back(fit_json(fit, current, !held_out.empty()));
  result["provenance"] = provenance_json();
  std::vector<plot::PlotPage> plots;
  for (const ServoLog& log : held_out) plots.push_back(page_of(log, fits.front(), best));
  const auto leave = [&]() -> Result<void> {
    KAZ_TRY(folder.clear());
    for (std::size_t i = 0; i < plots.size(); ++i)
      KAZ_TRY(folder.write("held-out-" + std::to_string(i + 1) + ".svg", plot::plot_svg(plots[i])));
    KAZ_TRY(folder.write("report.html", html(report, best, plots)));
    return folder.write_json("result.json", result);
  };
  const auto left = leave();
  if (arguments.json)
    print_json(result);
  else
    print(report, best, folder.path("report.html"));
  KAZ_TRY(left);
  return true;
}

}  // namespace kaz::tools
