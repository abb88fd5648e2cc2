// A report as one HTML page.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "hil/bench/report.h"
#include "hil/bench/report/numbers.h"
#include "hil/report/page.h"
#include "shared/base/xml_text.hpp"
#include "shared/plot/svg.h"

namespace kaz::hil {
namespace {

const char* const kBenchStyle = R"(
h1 + p { margin-top: .2em } td { vertical-align: middle } td small { color: #777; display: block }
td.number small { display: inline; color: #222 } td svg { display: block }
.subjects a { margin-right: 1.2em; white-space: nowrap } .message { display: block }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(30em, 1fr)); gap: 1em;
         margin-top: 1.2em }
figure { margin: 0; border: 1px solid #e4e6e9; border-radius: 4px; padding: .4em }
figure svg { display: block; max-width: 100%; height: auto }
@media print {
  body { margin: 0; max-width: none; font-size: 11px } a { color: inherit; text-decoration: none }
  figure, tr { break-inside: avoid } h2 { break-after: avoid }
  .plots { grid-template-columns: 1fr 1fr }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact }
}
)";

// Where a value lies between its limits, which stand at a fifth and four fifths of the bar; past a
// limit that stands alone, at so many times its size.
class LimitBar {
 public:
  explicit LimitBar(const Measurement& one) : one_(one) {}

  std::string text() const {
    if (std::isnan(one_.value)) return {};
    const double low = std::isinf(one_.low) ? 0 : kMargin;
    const double high = std::isinf(one_.high) ? 1 : 1 - kMargin;
    const bool failed = one_.verdict == Verdict::failed;
    const char* color = failed ? "#b00020" : "#176b2c";
    std::string svg =
        "<svg width=\"130\" height=\"16\" viewBox=\"0 0 130 16\" role=\"img\"><title>" +
        xml_text(value_with_unit(one_) + ", limits: " + limits_text(one_.low, one_.high)) +
        "</title>";
    svg += rectangle(0, 1, 5, 6, "#eceef1");
    svg += rectangle(low, high, 5, 6, "#bfe3c8");
    if (std::isfinite(one_.low)) svg += rectangle(low, low + 0.01, 2, 12, "#6b7178");
    if (std::isfinite(one_.high)) svg += rectangle(high - 0.01, high, 2, 12, "#6b7178");
    const double at = place(one_.value);
    if (one_.error > 0 && std::isfinite(one_.error)) {
      svg += rectangle(place(one_.value - one_.error), place(one_.value + one_.error), 7, 2, color);
    }
    return svg + "<circle cx=\"" + fixed(kEdge + at * kWide, 1) + "\" cy=\"8\" r=\"4\" fill=\"" +
           color + "\"/></svg>";
  }

 private:
  static constexpr double kMargin = 0.2, kEdge = 5, kWide = 120;

  static std::string rectangle(double from, double to, int top, int height, const char* color) {
    return "<rect x=\"" + fixed(kEdge + from * kWide, 1) + "\" y=\"" + std::to_string(top) +
           "\" width=\"" + fixed((to - from) * kWide, 1) + "\" height=\"" + std::to_string(height) +
           "\" fill=\"" + color + "\"/>";
  }

  double place(double value) const {
    const double inside = 1 - 2 * kMargin;
    double at = 0.5;
    if (std::isfinite(one_.low) && std::isfinite(one_.high)) {
      const double range = one_.high - one_.low;
      at = kMargin + inside * (value - one_.low) / (range > 0 ? range : 1);
    } else if (std::isfinite(one_.high)) {
      at = 1 - kMargin + (1 - kMargin) * (value - one_.high) / size(one_.high);
    } else if (std::isfinite(one_.low)) {
      at = kMargin + (1 - kMargin) * (value - one_.low) / (4 * size(one_.low));
    }
    return std::clamp(at, 0.0, 1.0);
  }
  static double size(double limit) { return limit == 0 ? 1 : std::abs(limit); }

  const Measurement& one_;
};

std::string measurement_row(const Measurement& one, bool with_subject) {
  std::string row = row_begin(one.verdict);
  if (with_subject) row += "<td>" + xml_text(one.subject) + "</td>";
  row += "<td><code>" + xml_text(one.of->name) + "</code><small>" + xml_text(one.of->text) +
         "</small>";
  if (!one.message.empty()) {
    row += "<span class=\"message " + std::string(verdict_class(one.verdict)) + "\">" +
           xml_text(one.message) + "</span>";
  }
  row += "</td><td class=\"number\">" + xml_text(value_text(one.value, one.error));
  if (one.error > 0 && std::isfinite(one.error)) {
    row += " <small>± " + value_text(one.error, one.error) + "</small>";
  }
  return row + "</td><td>" + xml_text(one.of->unit) + "</td><td>" + limits_text(one.low, one.high) +
         "</td><td>" + LimitBar(one).text() + "</td>" + verdict_cell(one.verdict) + "</tr>\n";
}

std::string table(const std::string& rows, bool with_subject) {
  return std::string("<table><tr>") + (with_subject ? "<th>subject</th>" : "") +
         "<th>measurement</th><th>value</th><th>unit</th><th>limits</th><th></th><th>verdict</th>"
         "</tr>\n" +
         rows + "</table>\n";
}

// In the order in which they were first measured or drawn.
std::vector<std::string> subjects(const BenchReport& report) {
  std::vector<std::string> all;
  const auto add = [&](const std::string& subject) {
    if (std::find(all.begin(), all.end(), subject) == all.end()) all.push_back(subject);
  };
  for (const Measurement& one : report.measurements) add(one.subject);
  for (const Plot& plot : report.plots) add(plot.subject);
  return all;
}

std::string anchor(std::size_t number) {
  return "subject-" + std::to_string(number + 1);
}

std::string subject_links(const BenchReport& report, const std::vector<std::string>& all) {
  std::string text = "<p class=\"subjects\">";
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool failed = std::any_of(
        report.measurements.begin(), report.measurements.end(), [&](const Measurement& one) {
          return one.subject == all[i] && one.verdict == Verdict::failed;
        });
    text += "<a href=\"#" + anchor(i) + "\"" + (failed ? " class=\"failed\"" : "") + ">" +
            xml_text(all[i]) + "</a> ";
  }
  return text + "</p>\n";
}

std::string subject_part(const BenchReport& report, const std::string& subject,
                         const std::string& id) {
  std::string text = "<h2 id=\"" + id + "\">" + xml_text(subject) + "</h2>\n";
  std::string rows, figures;
  for (const Measurement& one : report.measurements) {
    if (one.subject == subject) rows += measurement_row(one, false);
  }
  if (!rows.empty()) text += table(rows, false);
  for (const Plot& plot : report.plots) {
    if (plot.subject == subject)
      figures += "<figure>\n" + plot::plot_svg(plot_page(plot)) + "</figure>\n";
  }
  if (!figures.empty()) text += "<div class=\"plots\">\n" + figures + "</div>\n";
  return text;
}

std::string facts(const BenchReport& report) {
  std::string text = "<p class=\"facts\">" + xml_text(report.board) + "<br>on " +
                     xml_text(report.port) + "<br>measured by " + xml_text(report.program) +
                     (report.seed ? ", seed " + std::to_string(*report.seed) : "") + ", in " +
                     fixed(report.seconds, 1) + " s of the board's time";
  for (const auto& [name, value] : report.conditions) {
    text += "<br>" + xml_text(name) + ": " + xml_text(value_text(value));
  }
  return text + provenance_html(report.from) + "</p>\n";
}

std::string verdict_heading(const BenchReport& report) {
  if (!report.interrupted.empty()) {
    return "<h1>Bench: <span class=\"failed\">incomplete</span></h1>\n<p class=\"failed\">The run "
           "ended early: " +
           xml_text(report.interrupted) + "</p>\n";
  }
  if (report.count(Verdict::failed) > 0) {
    return "<h1>Bench: <span class=\"failed\">outside its limits</span></h1>\n";
  }
  if (report.count(Verdict::undecided) > 0) {
    const char* why = report.doubts(Measurement::Doubt::motor)  ? "a motor was warm"
                      : report.doubts(Measurement::Doubt::line) ? "the line was disturbed"
                                                                : "this machine was late";
    return std::string("<h1>Bench: <span class=\"out\">undecided: ") + why + "</span></h1>\n";
  }
  if (report.count(Verdict::passed) == 0) {
    return "<h1>Bench: <span class=\"out\">nothing was measured</span></h1>\n";
  }
  return "<h1>Bench: <span class=\"passed\">within its limits</span></h1>\n";
}

}  // namespace

std::string bench_html(const BenchReport& report) {
  std::string text = page_head("Kaz bench: " + report.port, kBenchStyle);
  text += verdict_heading(report);
  text += "<p>" + std::to_string(report.count(Verdict::passed)) + " of " +
          std::to_string(report.measurements.size()) + " measurements passed, " +
          std::to_string(report.count(Verdict::failed)) + " failed, " +
          std::to_string(report.count(Verdict::left_out)) + " left out, " +
          std::to_string(report.count(Verdict::undecided)) + " undecided.</p>\n";
  text += facts(report);
  const std::vector<std::string> all = subjects(report);
  if (all.size() > 1) {
    text += subject_links(report, all);
    std::string failed;
    for (const Measurement& one : report.measurements) {
      if (one.verdict == Verdict::failed) failed += measurement_row(one, true);
    }
    if (!failed.empty()) text += "<h2>Failed measurements</h2>\n" + table(failed, true);
  }
  for (std::size_t i = 0; i < all.size(); ++i) text += subject_part(report, all[i], anchor(i));
  return text + kPageEnd;
}

}  // namespace kaz::hil
