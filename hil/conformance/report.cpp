// A run of the suite as JUnit XML, JSON and one HTML page.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/report.h"

#include <cstdio>
#include <map>

#include <nlohmann/json.hpp>

#include "shared/base/xml_text.hpp"

namespace kaz::hil {
namespace {

std::string fixed(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string joined(const std::vector<std::string>& lines, const char* between) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : between) + line;
  return text;
}

double total_seconds(const RunReport& report) {
  double total = 0;
  for (const CaseResult& one : report.results) total += one.seconds;
  return total;
}

const char* const kStyle = R"(
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 72em; padding: 0 1em;
       color: #222; background: #fff }
h1 { font-size: 1.5em; margin-bottom: .2em } h2 { font-size: 1.15em; margin-top: 2em }
.facts { color: #555 } table { border-collapse: collapse; width: 100% }
th { text-align: left; border-bottom: 2px solid #888; padding: .3em .6em }
td { border-bottom: 1px solid #ddd; padding: .3em .6em; vertical-align: top }
td.number { text-align: right; white-space: nowrap } code { font-size: .92em }
.passed { color: #176b2c } .failed { color: #b00020; font-weight: 600 } .out { color: #777 }
tr.failed-row td { background: #fdf1f2; font-weight: normal; color: #222 }
pre { background: #f5f5f5; padding: .6em; overflow-x: auto; font-size: .85em; white-space: pre-wrap }
@media print { pre { white-space: pre-wrap } }
)";

std::string verdict_cell(const CaseResult& one) {
  const char* style = one.verdict == Verdict::passed   ? "passed"
                      : one.verdict == Verdict::failed ? "failed"
                                                       : "out";
  return std::string("<td class=\"") + style + "\">" + verdict_text(one.verdict) + "</td>";
}

std::string case_row(const CaseResult& one) {
  const bool failed = one.verdict == Verdict::failed;
  std::string row = failed ? "<tr class=\"failed-row\">" : "<tr>";
  row += "<td><code>" + xml_text(one.of->id) + "</code></td><td>" + xml_text(one.of->sentence);
  if (!one.message.empty()) {
    row += "<br><span class=\"" + std::string(failed ? "failed" : "out") + "\">" +
           xml_text(one.message) + "</span>";
  }
  if (failed) {
    row += "<details><summary>bytes exchanged (&gt; to the board, &lt; from it)</summary><pre>" +
           xml_text(joined(one.transcript, "\n")) + "</pre></details>";
  }
  row += "</td><td>" + joined(one.of->statements, ", ") + "</td>" + verdict_cell(one) +
         "<td class=\"number\">" + fixed(1e3 * one.seconds, 0) + " ms</td></tr>\n";
  return row;
}

// What each statement of the page came to by its cases.
std::string statement_rows(const RunReport& report) {
  std::map<std::string, std::array<int, 3>> counts;
  for (const CaseResult& one : report.results) {
    for (const std::string& id : one.of->statements) {
      ++counts[id][static_cast<std::size_t>(one.verdict)];
    }
  }
  std::string rows;
  for (const Statement& statement : statements()) {
    const auto found = counts.find(statement.id);
    if (found == counts.end()) continue;
    const auto [passed, failed, out] = found->second;
    rows += "<tr><td>" + statement.id + "</td><td>" + xml_text(statement.text) + "</td>";
    rows += failed   ? "<td class=\"failed\">failed</td>"
            : passed ? "<td class=\"passed\">passed</td>"
                     : "<td class=\"out\">left out</td>";
    rows += "<td class=\"number\">" + std::to_string(passed) + " of " +
            std::to_string(passed + failed + out) + "</td></tr>\n";
  }
  return rows;
}

}  // namespace

std::string junit_text(const RunReport& report, const ReportFacts& facts) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  text += "<testsuite name=\"kaz conformance\" tests=\"" + std::to_string(report.results.size()) +
          "\" failures=\"" + std::to_string(report.count(Verdict::failed)) + "\" errors=\"0\"" +
          " skipped=\"" + std::to_string(report.count(Verdict::left_out)) + "\" time=\"" +
          fixed(total_seconds(report), 3) + "\">\n  <properties>\n";
  const auto property = [&](const char* name, const std::string& value) {
    text +=
        "    <property name=\"" + std::string(name) + "\" value=\"" + xml_text(value) + "\"/>\n";
  };
  property("board", report.board);
  property("port", facts.port);
  property("program", facts.program);
  property("seed", std::to_string(facts.seed));
  text += "  </properties>\n";
  for (const CaseResult& one : report.results) {
    const std::string group = one.of->id.substr(0, one.of->id.find('.'));
    text += "  <testcase classname=\"" + group + "\" name=\"" + xml_text(one.of->id) +
            "\" time=\"" + fixed(one.seconds, 3) + "\"";
    if (one.verdict == Verdict::passed) {
      text += "/>\n";
    } else if (one.verdict == Verdict::left_out) {
      text += "><skipped message=\"" + xml_text(one.message) + "\"/></testcase>\n";
    } else {
      text += "><failure message=\"" + xml_text(one.message) + "\">" +
              xml_text(joined(one.of->statements, ", ") + ": " + one.of->sentence + "\n" +
                       joined(one.transcript, "\n")) +
              "</failure></testcase>\n";
    }
  }
  return text + "</testsuite>\n";
}

std::string json_text(const RunReport& report, const ReportFacts& facts) {
  nlohmann::ordered_json all;
  all["board"] = report.board;
  all["port"] = facts.port;
  all["program"] = facts.program;
  all["seed"] = facts.seed;
  all["cases"] = report.results.size();
  all["passed"] = report.count(Verdict::passed);
  all["failed"] = report.count(Verdict::failed);
  all["left_out"] = report.count(Verdict::left_out);
  all["seconds"] = total_seconds(report);
  all["results"] = nlohmann::ordered_json::array();
  for (const CaseResult& one : report.results) {
    nlohmann::ordered_json result;
    result["id"] = one.of->id;
    result["sentence"] = one.of->sentence;
    result["statements"] = one.of->statements;
    result["verdict"] = verdict_text(one.verdict);
    if (!one.message.empty()) result["message"] = one.message;
    result["seconds"] = one.seconds;
    if (!one.transcript.empty()) result["bytes"] = one.transcript;
    all["results"].push_back(std::move(result));
  }
  return all.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string html_text(const RunReport& report, const ReportFacts& facts) {
  const int failed = report.count(Verdict::failed);
  std::string text = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n";
  text += "<title>Kaz conformance: " + xml_text(facts.port) + "</title>\n<style>" +
          std::string(kStyle) + "</style></head><body>\n";
  text += "<h1>Protocol conformance: <span class=\"" +
          std::string(failed ? "failed\">does not conform" : "passed\">conforms") +
          "</span></h1>\n";
  text += "<p>" + std::to_string(report.count(Verdict::passed)) + " of " +
          std::to_string(report.results.size()) + " cases passed, " + std::to_string(failed) +
          " failed, " + std::to_string(report.count(Verdict::left_out)) + " left out.</p>\n";
  text += "<p class=\"facts\">" + xml_text(report.board) + "<br>on " + xml_text(facts.port) +
          "<br>examined by " + xml_text(facts.program) + ", seed " + std::to_string(facts.seed) +
          ", in " + fixed(total_seconds(report), 1) + " s of the board's time</p>\n";
  const auto table = [&](Verdict verdict, const char* title) {
    std::string rows;
    for (const CaseResult& one : report.results) {
      if (one.verdict == verdict) rows += case_row(one);
    }
    if (rows.empty()) return;
    text += "<h2>" + std::string(title) +
            "</h2>\n<table><tr><th>case</th><th>shows</th><th>statement</th><th>result</th>"
            "<th>time</th></tr>\n" +
            rows + "</table>\n";
  };
  table(Verdict::failed, "Cases that failed");
  text +=
      "<h2>Statements of docs/protocol.md</h2>\n<table><tr><th>statement</th><th>says</th>"
      "<th>result</th><th>cases passed</th></tr>\n" +
      statement_rows(report) + "</table>\n";
  table(Verdict::passed, "Cases that passed");
  table(Verdict::left_out, "Cases that were left out");
  return text + "</body></html>\n";
}

}  // namespace kaz::hil
