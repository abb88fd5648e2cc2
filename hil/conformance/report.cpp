// A run of the suite as JUnit XML, JSON and one HTML page.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/report.h"

#include <array>
#include <map>

#include <nlohmann/json.hpp>

#include "hil/report/junit.h"
#include "hil/report/page.h"
#include "shared/base/xml_text.hpp"

namespace kaz::hil {
namespace {

double total_seconds(const RunReport& report) {
  double total = 0;
  for (const CaseResult& one : report.results) total += one.seconds;
  return total;
}

std::string case_row(const CaseResult& one) {
  const bool failed = one.verdict == Verdict::failed;
  const bool bytes = failed || one.verdict == Verdict::undecided;
  std::string row = row_begin(one.verdict);
  row += "<td><code>" + xml_text(one.of->id) + "</code></td><td>" + xml_text(one.of->sentence);
  if (!one.message.empty()) {
    row += "<br><span class=\"" + std::string(failed ? "failed" : "out") + "\">" +
           xml_text(one.message) + "</span>";
  }
  if (bytes) {
    row +=
        "<details><summary>bytes exchanged (&gt; to the board, &lt; from the "
        "board)</summary><pre>" +
        xml_text(joined(one.transcript, "\n")) + "</pre></details>";
  }
  row += "</td><td>" + joined(one.of->statements, ", ") + "</td>" + verdict_cell(one.verdict) +
         "<td class=\"number\">" + fixed(1e3 * one.seconds, 0) + " ms</td></tr>\n";
  return row;
}

// What each statement of the page came to by its cases.
std::string statement_rows(const RunReport& report) {
  std::map<std::string, std::array<int, 4>> counts;
  for (const CaseResult& one : report.results) {
    for (const std::string& id : one.of->statements) {
      ++counts[id][static_cast<std::size_t>(one.verdict)];
    }
  }
  std::string rows;
  for (const Statement& statement : statements()) {
    const auto found = counts.find(statement.id);
    if (found == counts.end()) continue;
    const auto [passed, failed, out, undecided] = found->second;
    rows += "<tr><td>" + statement.id + "</td><td>" + xml_text(statement.text) + "</td>";
    rows += failed      ? "<td class=\"failed\">failed</td>"
            : undecided ? "<td class=\"out\">undecided</td>"
            : passed    ? "<td class=\"passed\">passed</td>"
                        : "<td class=\"out\">left out</td>";
    rows += "<td class=\"number\">" + std::to_string(passed) + " of " +
            std::to_string(passed + failed + out + undecided) + "</td></tr>\n";
  }
  return rows;
}

// "SIGINT, after 12 of 160 cases"
std::string interruption(const RunReport& report, const ReportFacts& facts) {
  return facts.signal + ", after " + std::to_string(report.results.size()) + " of " +
         std::to_string(report.chosen()) + " cases";
}

}  // namespace

std::string junit_text(const RunReport& report, const ReportFacts& facts) {
  const std::string end =
      report.interrupted ? "interrupted by " + interruption(report, facts) : facts.broken_off;
  JunitSuite suite("kaz conformance",
                   {report.count(Verdict::passed), report.count(Verdict::failed),
                    report.count(Verdict::left_out) + static_cast<int>(report.not_run.size()),
                    report.count(Verdict::undecided), end.empty() ? 0 : 1},
                   total_seconds(report));
  suite.property("board", report.board);
  suite.property("port", facts.port);
  suite.property("program", facts.program);
  suite.property("seed", std::to_string(facts.seed));
  if (report.interrupted) suite.property("interrupted", interruption(report, facts));
  for (const auto& [name, value] : provenance_properties(facts.from)) suite.property(name, value);
  for (const CaseResult& one : report.results) {
    suite.add({one.of->id.substr(0, one.of->id.find('.')),
               one.of->id,
               one.verdict == Verdict::left_out ? std::nullopt : std::optional(one.seconds),
               one.verdict,
               one.message,
               joined(one.of->statements, ", ") + ": " + one.of->sentence + "\n" +
                   joined(one.transcript, "\n"),
               {}});
  }
  for (const Case* one : report.not_run) {
    suite.add({one->id.substr(0, one->id.find('.')),
               one->id,
               std::nullopt,
               Verdict::left_out,
               "not run: the run ended early",
               {},
               {}});
  }
  if (!end.empty()) suite.add_error("conformance", "the run is complete", end);
  return suite.finish();
}

std::string json_text(const RunReport& report, const ReportFacts& facts) {
  nlohmann::ordered_json all;
  all["board"] = report.board;
  all["port"] = facts.port;
  all["program"] = facts.program;
  all["seed"] = facts.seed;
  if (report.interrupted) {
    all["interrupted"] = true;
    all["signal"] = facts.signal;
    all["cases_chosen"] = report.chosen();
  }
  all["provenance"] = provenance_json(facts.from);
  all["cases"] = report.results.size();
  all["passed"] = report.count(Verdict::passed);
  all["failed"] = report.count(Verdict::failed);
  all["left_out"] = report.count(Verdict::left_out);
  all["undecided"] = report.count(Verdict::undecided);
  all["seconds"] = total_seconds(report);
  if (!facts.broken_off.empty()) all["error"] = facts.broken_off;
  all["results"] = nlohmann::ordered_json::array();
  for (const CaseResult& one : report.results) {
    nlohmann::ordered_json result;
    result["id"] = one.of->id;
    result["sentence"] = one.of->sentence;
    result["statements"] = one.of->statements;
    result["verdict"] = verdict_text(one.verdict);
    if (!one.message.empty()) result["message"] = one.message;
    if (one.runs > 1) result["runs"] = one.runs;
    if (one.verdict != Verdict::left_out) result["seconds"] = one.seconds;
    if (!one.transcript.empty()) result["bytes"] = one.transcript;
    all["results"].push_back(std::move(result));
  }
  return all.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string html_text(const RunReport& report, const ReportFacts& facts) {
  const int failed = report.count(Verdict::failed), undecided = report.count(Verdict::undecided);
  std::string text = page_head("Kaz conformance: " + facts.port);
  const char* const heading = failed                      ? "failed\">does not conform"
                              : report.interrupted        ? "out\">incomplete"
                              : !facts.broken_off.empty() ? "out\">not decided"
                              : undecided                 ? "out\">undecided"
                                                          : "passed\">conforms";
  text += "<h1>Protocol conformance: <span class=\"" + std::string(heading) + "</span></h1>\n";
  if (report.interrupted)
    text +=
        "<p class=\"failed\">Interrupted by " + xml_text(interruption(report, facts)) + ".</p>\n";
  text += "<p>" + std::to_string(report.count(Verdict::passed)) + " of " +
          std::to_string(report.results.size()) + " cases passed, " + std::to_string(failed) +
          " failed, " + std::to_string(report.count(Verdict::left_out)) + " left out, " +
          std::to_string(undecided) + " undecided.</p>\n";
  text += "<p class=\"facts\">" + xml_text(report.board) + "<br>on " + xml_text(facts.port) +
          "<br>tested by " + xml_text(facts.program) + ", seed " + std::to_string(facts.seed) +
          ", in " + fixed(total_seconds(report), 1) + " s of the board's time" +
          provenance_html(facts.from) + "</p>\n";
  if (!facts.broken_off.empty())
    text += "<p class=\"failed\">The run ended early: " + xml_text(facts.broken_off) + "</p>\n";
  const auto table = [&](Verdict verdict, const char* title) {
    std::string rows;
    for (const CaseResult& one : report.results) {
      if (one.verdict == verdict) rows += case_row(one);
    }
    if (rows.empty()) return;
    text += "<h2>" + std::string(title) +
            "</h2>\n<table><tr><th>case</th><th>requirement</th><th>clause</th><th>result</th>"
            "<th>time</th></tr>\n" +
            rows + "</table>\n";
  };
  table(Verdict::failed, "Failed cases");
  table(Verdict::undecided, "Undecided cases: this machine was late");
  if (const std::string rows = statement_rows(report); !rows.empty())
    text +=
        "<h2>Clauses of docs/reference/protocol.md</h2>\n<table><tr><th>clause</th><th>text</th>"
        "<th>result</th><th>cases passed</th></tr>\n" +
        rows + "</table>\n";
  table(Verdict::passed, "Passed cases");
  table(Verdict::left_out, "Cases left out");
  return text + kPageEnd;
}

}  // namespace kaz::hil
