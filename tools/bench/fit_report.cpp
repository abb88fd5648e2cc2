// A fit of the motor model for machines and people.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/fit_report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "hil/bench/report.h"
#include "hil/report/page.h"
#include "shared/base/xml_text.hpp"
#include "shared/plot/svg.h"

namespace kaz::tools {
namespace {

using lockstep::FittedParam;
using lockstep::Gap;
using lockstep::MotorFit;

std::string short_number(double value) {
  if (std::isnan(value)) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// "+3.1 %"
std::string change(double from, double to) {
  char text[40];
  std::snprintf(text, sizeof text, "%+.1f %%", 100 * (to / from - 1));
  return text;
}

const char* const kStyle = R"(
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(30em, 1fr)); gap: 1em }
figure { margin: 0; border: 1px solid #e4e6e9; border-radius: 4px; padding: .4em }
figure svg { display: block; max-width: 100%; height: auto }
)";

}  // namespace

nlohmann::ordered_json fit_json(const MotorFit& fit) {
  nlohmann::ordered_json all;
  all["motor"] = fit.motor.name;
  all["rounds"] = fit.rounds;
  all["last_change"] = fit.last_change;
  for (const FittedParam& one : fit.params) {
    all["measurements"][one.name] = {{"unit", one.unit},
                                     {"measured", one.measured},
                                     {"before", one.before},
                                     {"after", one.after}};
  }
  for (const Gap& one : fit.gaps) {
    auto& gap = all["gaps"][one.name];
    gap["unit"] = one.unit;
    if (!std::isnan(one.measured)) gap["measured"] = one.measured;
    gap["before"] = one.before;
    gap["after"] = one.after;
  }
  return all;
}

std::string fit_text(const MotorFit& fit) {
  std::string text;
  char line[160];
  std::snprintf(line, sizeof line, "%-24s %-9s %11s %11s\n", "parameter", "unit", "before",
                "after");
  text += line;
  for (const FittedParam& one : fit.params) {
    std::snprintf(line, sizeof line, "%-24s %-9s %11s %11s  %s\n", one.name.c_str(),
                  one.unit.c_str(), short_number(one.before).c_str(),
                  short_number(one.after).c_str(),
                  one.measured ? change(one.before, one.after).c_str() : "not measured, unchanged");
    text += line;
  }
  std::snprintf(line, sizeof line, "\n%-24s %-9s %11s %11s %11s\n", "gap", "unit", "measured",
                "before", "after");
  text += line;
  for (const Gap& one : fit.gaps) {
    std::snprintf(line, sizeof line, "%-24s %-9s %11s %11s %11s\n", one.name.c_str(),
                  one.unit.c_str(), short_number(one.measured).c_str(),
                  short_number(one.before).c_str(), short_number(one.after).c_str());
    text += line;
  }
  return text;
}

std::string fit_html(const MotorFit& fit, const std::string& report, const hil::Provenance& from) {
  std::string text = hil::page_head("Kaz bench fit: " + fit.motor.name, kStyle);
  text += "<h1>Motor model fitted</h1>\n<p class=\"facts\">" + xml_text(fit.motor.name) +
          "<br>fitted to " + xml_text(report) + "<br>by kaz " + xml_text(from.kaz) + ", in " +
          std::to_string(fit.rounds) + " rounds of the bench on the model" +
          hil::provenance_html(from) +
          "</p>\n<h2>Parameters</h2>\n<table><tr><th>parameter</th>"
          "<th>unit</th><th>before</th><th>after</th><th>change</th></tr>\n";
  for (const FittedParam& one : fit.params) {
    text +=
        hil::table_row({one.name, one.unit, short_number(one.before), short_number(one.after),
                        one.measured ? change(one.before, one.after) : "not measured, unchanged"});
  }
  text +=
      "</table>\n"
      "<h2>Gap between motor and model</h2>\n"
      "<p>The bench measures the model in the same way as the motor. For a curve, the gap is the "
      "root mean square of the difference between measurement and model.</p>\n"
      "<table><tr><th>measurement</th><th>unit</th><th>measured</th><th>model before</th><th>model "
      "after</th></tr>\n";
  for (const Gap& one : fit.gaps) {
    text += hil::table_row({one.name, one.unit, short_number(one.measured),
                            short_number(one.before), short_number(one.after)});
  }
  text += "</table>\n<div class=\"plots\">\n";
  for (const hil::Plot& plot : fit.plots)
    text += "<figure>\n" + plot::plot_svg(hil::plot_page(plot)) + "</figure>\n";
  return text + "</div>\n" + hil::kPageEnd;
}

}  // namespace kaz::tools
