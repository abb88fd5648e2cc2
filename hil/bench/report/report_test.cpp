// Reports: what they hold, that they are well-formed, and back from JSON.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil/bench/report/numbers.h"
#include "hil/bench/report/report_testing.h"
#include "shared/base/json_testing.h"
#include "shared/base/xml_testing.hpp"

namespace kaz::hil {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

bool same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || a == b;
}

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

void expect_same(const Measurement& a, const Measurement& b) {
  EXPECT_EQ(a.of, b.of);
  EXPECT_EQ(a.subject, b.subject);
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_TRUE(same(a.value, b.value)) << a.of->name;
  EXPECT_TRUE(same(a.error, b.error)) << a.of->name;
  EXPECT_EQ(a.low, b.low) << a.of->name;
  EXPECT_EQ(a.high, b.high) << a.of->name;
  EXPECT_EQ(a.message, b.message);
}

void expect_same(const Plot& a, const Plot& b) {
  EXPECT_EQ(std::tie(a.id, a.subject, a.title, a.x_label, a.y_label, a.x_logarithmic, a.caption),
            std::tie(b.id, b.subject, b.title, b.x_label, b.y_label, b.x_logarithmic, b.caption));
  ASSERT_EQ(a.series.size(), b.series.size());
  for (std::size_t i = 0; i < a.series.size(); ++i) {
    EXPECT_EQ(a.series[i].name, b.series[i].name);
    EXPECT_EQ(a.series[i].style, b.series[i].style);
    ASSERT_EQ(a.series[i].points.size(), b.series[i].points.size());
    for (std::size_t k = 0; k < a.series[i].points.size(); ++k) {
      EXPECT_TRUE(same(a.series[i].points[k].first, b.series[i].points[k].first));
      EXPECT_TRUE(same(a.series[i].points[k].second, b.series[i].points[k].second));
    }
  }
}

TEST(BenchJson, ComesBackAsItWas) {
  const BenchReport was = test_report();
  const auto is = parse_bench_json(bench_json(was), "report.json");
  ASSERT_TRUE(is) << is.error().message;
  EXPECT_EQ(std::tie(was.board, was.port, was.program, was.seed, was.conditions, was.seconds),
            std::tie(is->board, is->port, is->program, is->seed, is->conditions, is->seconds));
  ASSERT_EQ(is->measurements.size(), was.measurements.size());
  for (std::size_t i = 0; i < was.measurements.size(); ++i) {
    expect_same(was.measurements[i], is->measurements[i]);
  }
  ASSERT_EQ(is->plots.size(), was.plots.size());
  for (std::size_t i = 0; i < was.plots.size(); ++i) expect_same(was.plots[i], is->plots[i]);
  EXPECT_EQ(bench_json(*is), bench_json(was));
}

TEST(BenchReports, HaveNoValueOfWhatWasLeftOut) {
  const BenchReport report = test_report();
  const auto all = parse_json(bench_json(report));
  int left_out = 0;
  for (const auto& one : all["measurements"]) {
    if (one["verdict"] != "left out") continue;
    ++left_out;
    EXPECT_TRUE(one["value"].is_null());
    EXPECT_TRUE(one["error"].is_null());
    const std::string row =
        one["subject"].get<std::string>() + "," + one["name"].get<std::string>() + ",,,";
    EXPECT_NE(bench_csv(report).find(row), std::string::npos) << bench_csv(report);
  }
  EXPECT_EQ(left_out, 1);
}

TEST(BenchReports, HaveTheirProvenance) {
  BenchReport report = test_report();
  report.from = {"2026-01-02T03:04:05Z", "0.1.0", "a <cpu>", "an OS", 2, "kaz bench 'all\n'"};
  const auto from = parse_json(bench_json(report))["provenance"];
  EXPECT_EQ(from["date"], "2026-01-02T03:04:05Z");
  EXPECT_EQ(from["machine"]["cores"], 2);
  EXPECT_EQ(from["command"], "kaz bench 'all '");
  EXPECT_NE(bench_junit(report).find("name=\"cpu\" value=\"a &lt;cpu&gt;\""), std::string::npos);
  EXPECT_NE(bench_html(report).find("2026-01-02T03:04:05Z"), std::string::npos);
}

// A board at a port has no noise to draw: no format may claim a seed.
TEST(BenchReports, HaveNoSeedOfABoardAtAPort) {
  BenchReport report = test_report();
  EXPECT_NE(bench_html(report).find(", seed 18446744073709551615"), std::string::npos);
  report.seed.reset();
  EXPECT_EQ(bench_html(report).find("seed"), std::string::npos);
  EXPECT_EQ(bench_junit(report).find("seed"), std::string::npos);
  EXPECT_FALSE(parse_json(bench_json(report)).contains("seed"));
  const auto is = parse_bench_json(bench_json(report), "report.json");
  ASSERT_TRUE(is) << is.error().message;
  EXPECT_FALSE(is->seed);
}

TEST(BenchJson, ReportsWhatIsThere) {
  const auto all = parse_json(bench_json(test_report()));
  EXPECT_EQ(all["passed"], 5);
  EXPECT_EQ(all["failed"], 3);
  EXPECT_EQ(all["left_out"], 1);
  EXPECT_EQ(all["measurements"].size(), 9u);
  EXPECT_EQ(all["measurements"][0]["name"], "stall.torque_4v8");
  EXPECT_EQ(all["measurements"][0]["unit"], "Nm");
  EXPECT_EQ(all["measurements"][1]["low"], nullptr);
  EXPECT_EQ(all["measurements"][3]["value"], "inf");
  EXPECT_EQ(all["measurements"][4]["value"], nullptr);
  EXPECT_EQ(all["plots"][0]["series"][2]["style"], "dashed");
}

TEST(BenchJson, AnEmptyReportComesBack) {
  const auto is = parse_bench_json(bench_json({}), "empty.json");
  ASSERT_TRUE(is) << is.error().message;
  EXPECT_TRUE(is->measurements.empty());
}

TEST(BenchJson, WhatIsNoReportIsWrongUsage) {
  const std::string good = bench_json(test_report());
  const auto with = [&](const std::string& part, const std::string& other) {
    std::string text = good;
    EXPECT_NE(text.find(part), std::string::npos);
    return text.replace(text.find(part), part.size(), other);
  };
  const std::pair<std::string, const char*> wrong[] = {
      {"", "line 1 is not valid JSON"},
      {good.substr(0, good.size() / 2), "not valid JSON"},
      {"{}", "not written by kaz bench"},
      {"[]", "not written by kaz bench"},
      {with("\"pot.noise\"", "\"pot.noice\""), "unknown measurement 'pot.noice'"},
      {with("\"unit\":\"Nm\"", "\"unit\":\"mNm\""), "the wrong unit"},
      {with("\"verdict\":\"passed\"", "\"verdict\":\"good\""), "unknown verdict 'good'"},
      {with("\"style\":\"dashed\"", "\"style\":\"dotted\""), "unknown style 'dotted'"},
      {with("\"value\":0.97", "\"value\":\"0.97\""), "not written by kaz bench"},
      {with("\"seed\": 18446744073709551615", "\"seed\": 18446744073709551616"),
       "seed must be a 64-bit unsigned integer"},
      {with("\"seed\": 18446744073709551615", "\"seed\": -1"),
       "seed must be a 64-bit unsigned integer"},
      {with("\"seed\": 18446744073709551615", "\"seed\": 1.5"),
       "seed must be a 64-bit unsigned integer"},
      {with("\"seed\": 18446744073709551615", "\"seed\": null"),
       "seed must be a 64-bit unsigned integer"},
  };
  for (const auto& [json, part] : wrong) {
    const auto report = parse_bench_json(json, "some/report.json");
    ASSERT_FALSE(report) << part;
    EXPECT_EQ(report.error().fault, Fault::usage);
    EXPECT_NE(report.error().message.find("some/report.json"), std::string::npos);
    EXPECT_NE(report.error().message.find(part), std::string::npos) << report.error().message;
  }
}

TEST(BenchCsv, HasALineForEachMeasurement) {
  const std::string text = bench_csv(test_report());
  EXPECT_EQ(count(text, "\n"), 10);
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "subject,name,value,error,unit,low,high,verdict,message");
  EXPECT_NE(text.find("neck_pan,stall.torque_4v8,0.97,0.004,Nm,0.9409,0.9991,passed,\n"),
            std::string::npos);
  EXPECT_NE(text.find("neck_pan,pot.noise,1.7,,codes,,1,failed,\"1.7 codes is above the limit of "
                      "1 codes; less < more & \"\"quoted\"\", with a comma\"\n"),
            std::string::npos);
  EXPECT_NE(text.find("neck_pan,backlash,,,deg,0.05,0.6,failed,the measurement gave no value\n"),
            std::string::npos);
  EXPECT_NE(text.find("neck_pan,frequency.bandwidth,inf,"), std::string::npos);
}

TEST(BenchCsv, HasALineForEachPointOfACurve) {
  const std::string text = bench_curves_csv(test_report());
  EXPECT_EQ(count(text, "\n"), 1 + 3 + 2 + 2 + 3);
  EXPECT_NE(text.find("neck_pan,stall,points,2,0.35\n"), std::string::npos);
  EXPECT_NE(text.find("neck_pan,stall,points,3,\n"), std::string::npos);
  EXPECT_NE(text.find("neck_pan,stall,\"line \"\"1\"\"\",0,-0.128\n"), std::string::npos);
  EXPECT_NE(text.find("link,phase,,20,-170\n"), std::string::npos);
}

TEST(BenchJunit, IsXmlWithACaseForEachMeasurement) {
  const BenchReport report = test_report();
  tinyxml2::XMLDocument document;
  parse_xml(bench_junit(report), document);
  const auto* suite = document.FirstChildElement("testsuite");
  ASSERT_TRUE(suite);
  EXPECT_EQ(suite->IntAttribute("tests"), 9);
  EXPECT_EQ(suite->IntAttribute("failures"), 3);
  EXPECT_EQ(suite->IntAttribute("skipped"), 1);
  EXPECT_EQ(suite->DoubleAttribute("time"), 12.25);
  const auto cases = elements(*suite, "testcase");
  ASSERT_EQ(cases.size(), report.measurements.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Measurement& one = report.measurements[i];
    EXPECT_STREQ(cases[i]->Attribute("classname"), one.subject.c_str());
    EXPECT_STREQ(cases[i]->Attribute("name"), one.of->name.c_str());
    EXPECT_EQ(cases[i]->FirstChildElement("failure") != nullptr, one.verdict == Verdict::failed);
    EXPECT_EQ(cases[i]->FirstChildElement("skipped") != nullptr, one.verdict == Verdict::left_out);
  }
  EXPECT_STREQ(cases[1]->FirstChildElement("failure")->Attribute("message"),
               report.measurements[1].message.c_str());
  EXPECT_STREQ(cases[0]->FirstChildElement("system-out")->GetText(),
               "0.9700 ± 0.004 Nm, limits: 0.9409 to 0.9991");
  EXPECT_EQ(elements(*suite, "property").size(), 6u);
}

TEST(BenchJunit, ARunThatBrokeOffIsAnErrorNotAFailure) {
  BenchReport report = test_report();
  report.interrupted = "the port is gone";
  tinyxml2::XMLDocument document;
  parse_xml(bench_junit(report), document);
  const auto* suite = document.FirstChildElement("testsuite");
  ASSERT_TRUE(suite);
  EXPECT_EQ(suite->IntAttribute("tests"), 10);
  EXPECT_EQ(suite->IntAttribute("failures"), 3);
  EXPECT_EQ(suite->IntAttribute("errors"), 1);
  const auto cases = elements(*suite, "testcase");
  ASSERT_EQ(cases.size(), 10u);
  ASSERT_TRUE(cases.back()->FirstChildElement("error"));
  EXPECT_STREQ(cases.back()->FirstChildElement("error")->Attribute("message"), "the port is gone");
}

// As XML: the page's elements without content are written without their end.
void parse_page(std::string page, tinyxml2::XMLDocument& to) {
  for (const auto& [open, closed] :
       {std::pair("<meta charset=\"utf-8\">", "<meta/>"), std::pair("<br>", "<br/>")}) {
    const std::string part = open;
    for (auto at = page.find(part); at != std::string::npos; at = page.find(part, at + 1)) {
      page.replace(at, part.size(), closed);
    }
  }
  parse_xml(page, to);
}

TEST(BenchHtml, IsOnePageThatFetchesNothing) {
  const std::string text = bench_html(test_report());
  tinyxml2::XMLDocument document;
  parse_page(text, document);
  EXPECT_EQ(count(text, "http"), count(text, "http://www.w3.org/2000/svg"));
  EXPECT_EQ(count(text, "<script"), 0);
  EXPECT_EQ(count(text, "nan") + count(text, "inf\""), 0);
  EXPECT_NE(text.find("outside its limits"), std::string::npos);
  EXPECT_NE(text.find("less &lt; more &amp; &quot;quoted&quot;, with a comma"), std::string::npos);
}

TEST(BenchHtml, HasEveryMeasurementAndPlot) {
  const BenchReport report = test_report();
  const std::string text = bench_html(report);
  tinyxml2::XMLDocument document;
  parse_page(text, document);
  for (const Measurement& one : report.measurements) {
    // Those that failed stand at the top as well.
    EXPECT_EQ(count(text, "<code>" + one.of->name + "</code>"),
              one.verdict == Verdict::failed ? 2 : 1);
  }
  EXPECT_EQ(elements(document, "figure").size(), report.plots.size());
  EXPECT_EQ(elements(document, "h2").size(), 1u + 3u);
  for (const auto* link : elements(document, "a")) {
    EXPECT_EQ(count(text, "id=\"" + std::string(link->Attribute("href") + 1) + "\""), 1);
  }
}

TEST(BenchHtml, SaysWhetherAllIsWell) {
  BenchReport report = test_report();
  std::erase_if(report.measurements,
                [](const Measurement& one) { return one.verdict == Verdict::failed; });
  EXPECT_NE(bench_html(report).find("within its limits"), std::string::npos);
  EXPECT_EQ(bench_html(report).find("Failed measurements"), std::string::npos);
  std::erase_if(report.measurements,
                [](const Measurement& one) { return one.verdict == Verdict::passed; });
  EXPECT_NE(bench_html(report).find("nothing was measured"), std::string::npos);
  EXPECT_NE(bench_html({}).find("nothing was measured"), std::string::npos);
}

TEST(BenchHtml, AllMeasurementsWithAnyValueMakeAPage) {
  for (const double value : {0.0, -1e300, 1e300, 1e-300, kInfinite, -kInfinite, 1.0}) {
    BenchReport report;
    const Limits none;
    BenchJudge judge(report, none);
    for (const MeasurementInfo& info : measurement_infos()) {
      judge.enter("board", info.name, value, std::abs(value) / 10);
    }
    tinyxml2::XMLDocument document;
    parse_page(bench_html(report), document);
    EXPECT_EQ(elements(document, "circle").size(), measurement_infos().size());
  }
}

TEST(BenchNumbers, ForPeople) {
  EXPECT_EQ(value_text(0.97), "0.97");
  EXPECT_EQ(value_text(0.97, 0.0041), "0.9700");
  EXPECT_EQ(value_text(12.3456), "12.35");
  EXPECT_EQ(value_text(-250.5, 30), "-250");
  EXPECT_EQ(value_text(0), "0");
  EXPECT_EQ(value_text(123456.7), "123457");
  EXPECT_EQ(value_text(1e9), "1e+09");
  EXPECT_EQ(value_text(std::nan("")), "none");
  EXPECT_EQ(value_text(-kInfinite), "minus infinity");
  EXPECT_EQ(limits_text(1, 2.5), "1 to 2.5");
  EXPECT_EQ(limits_text(-kInfinite, 0), "at most 0");
  EXPECT_EQ(limits_text(-60, kInfinite), "at least -60");
  EXPECT_EQ(exact_text(0.1), "0.1");
  EXPECT_EQ(exact_text(std::nan("")), "");
  EXPECT_EQ(exact_text(-kInfinite), "-inf");
}

}  // namespace
}  // namespace kaz::hil
