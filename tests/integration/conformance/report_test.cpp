// Reports of a run: what they hold, and that they are well-formed.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil/conformance/report.h"
#include "shared/base/json_testing.h"

namespace kaz::hil {
namespace {

const Case kGood{"frame.good", "A sentence.", {"FRAME-1"}, kNothing, {}};
const Case kBad{"frame.bad", "Less < more & \"quoted\".", {"FRAME-2", "SAFE-1"}, kNothing, {}};
const Case kOut{"bench.out", "Another.", {"BENCH-1"}, kMotion, {}};

RunReport report() {
  RunReport made;
  made.board = "Kaz servo board";
  made.results.push_back({&kGood, Verdict::passed, "", 0.25, {}});
  made.results.push_back({&kBad, Verdict::failed, "expected <1>, got 2", 0.5, {"> 00 01", "< 02"}});
  made.results.push_back({&kOut, Verdict::left_out, missing_text(kMotion), 0, {}});
  return made;
}

const ReportFacts kFacts{"/dev/tty&0", "kaz 0.1.0", 7};

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// Each element that is opened is closed again, in order.
void expect_balanced(const std::string& text) {
  std::vector<std::string> open;
  for (auto at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const auto end = text.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const std::string tag = text.substr(at + 1, end - at - 1);
    if (tag[0] == '?' || tag[0] == '!' || tag.back() == '/' || tag == "br" ||
        tag.rfind("meta", 0) == 0) {
      continue;
    }
    if (tag[0] == '/') {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ(open.back(), tag.substr(1));
      open.pop_back();
    } else {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
  }
  EXPECT_TRUE(open.empty());
}

TEST(ConformanceReport, Junit) {
  const std::string text = junit_text(report(), kFacts);
  expect_balanced(text);
  EXPECT_NE(text.find("tests=\"3\" failures=\"1\" errors=\"0\" skipped=\"1\" time=\"0.750\""),
            std::string::npos);
  EXPECT_EQ(count(text, "<testcase "), 3);
  EXPECT_NE(text.find("expected &lt;1&gt;, got 2"), std::string::npos);
  EXPECT_NE(text.find("&gt; 00 01"), std::string::npos);
  EXPECT_NE(text.find("/dev/tty&amp;0"), std::string::npos);
}

// A port that went is neither a case that passed nor one that failed.
TEST(ConformanceReport, ARunThatBrokeOffHasAnError) {
  ReportFacts facts = kFacts;
  facts.broken_off = "the port <x> is gone";
  RunReport passed = report();
  passed.results.erase(passed.results.begin() + 1);
  const std::string text = junit_text(passed, facts);
  expect_balanced(text);
  EXPECT_NE(text.find("tests=\"3\" failures=\"0\" errors=\"1\""), std::string::npos) << text;
  EXPECT_NE(text.find("<error message=\"the port &lt;x&gt; is gone\"/>"), std::string::npos)
      << text;
  EXPECT_EQ(parse_json(json_text(passed, facts))["error"], facts.broken_off);
  const std::string page = html_text(passed, facts);
  expect_balanced(page);
  EXPECT_NE(page.find("not decided"), std::string::npos);
  EXPECT_EQ(page.find("\">conforms"), std::string::npos);
}

// Its exit status is no success: a build server must not take it for one. What was not run has not passed.
TEST(ConformanceReport, AnInterruptedRunHasAnErrorAndSkippedCases) {
  ReportFacts facts = kFacts;
  facts.signal = "SIGINT";
  RunReport cut = report();
  cut.results.resize(1);
  cut.not_run = {&kBad, &kOut};
  cut.interrupted = true;
  const std::string text = junit_text(cut, facts);
  expect_balanced(text);
  EXPECT_NE(text.find("tests=\"4\" failures=\"0\" errors=\"1\" skipped=\"2\""), std::string::npos)
      << text;
  EXPECT_EQ(count(text, "<testcase "), 4);
  EXPECT_EQ(count(text, "<skipped message=\"not run: "), 2) << text;
  EXPECT_NE(text.find("<error message=\"interrupted by SIGINT, after 1 of 3 cases\"/>"),
            std::string::npos)
      << text;
  const auto all = parse_json(json_text(cut, facts));
  EXPECT_EQ(all["interrupted"], true);
  EXPECT_EQ(all["cases"], 1);
  EXPECT_EQ(all["cases_chosen"], 3);
}

TEST(ConformanceReport, Json) {
  const auto all = parse_json(json_text(report(), kFacts));
  EXPECT_EQ(all["cases"], 3);
  EXPECT_EQ(all["passed"], 1);
  EXPECT_EQ(all["failed"], 1);
  EXPECT_EQ(all["left_out"], 1);
  EXPECT_EQ(all["seed"], 7);
  EXPECT_EQ(all["results"][1]["id"], "frame.bad");
  EXPECT_EQ(all["results"][1]["verdict"], "failed");
  EXPECT_EQ(all["results"][1]["bytes"].size(), 2u);
  EXPECT_EQ(all["results"][2]["message"], "needs --allow-motion");
}

// Neither passed nor failed: counted by itself, skipped for build servers.
TEST(ConformanceReport, UndecidedCases) {
  RunReport late = report();
  late.results[1].verdict = Verdict::undecided;
  late.results[1].message = "no answer; but this program was kept waiting";
  late.results[1].runs = 4;
  const auto all = parse_json(json_text(late, kFacts));
  EXPECT_EQ(all["failed"], 0);
  EXPECT_EQ(all["left_out"], 1);
  EXPECT_EQ(all["undecided"], 1);
  EXPECT_EQ(all["results"][1]["verdict"], "undecided");
  EXPECT_EQ(all["results"][1]["runs"], 4);
  EXPECT_EQ(all["results"][1]["bytes"].size(), 2u);
  const std::string xml = junit_text(late, kFacts);
  expect_balanced(xml);
  EXPECT_NE(xml.find("tests=\"3\" failures=\"0\" errors=\"0\" skipped=\"2\""), std::string::npos)
      << xml;
  EXPECT_EQ(count(xml, "<skipped message=\"undecided: no answer; but "), 1) << xml;
  const std::string page = html_text(late, kFacts);
  expect_balanced(page);
  EXPECT_EQ(count(page, "conform</span>") + count(page, "conforms</span>"), 0) << page;
  EXPECT_NE(page.find("1 undecided"), std::string::npos);
}

TEST(ConformanceReport, HtmlIsOnePageThatFetchesNothing) {
  const std::string text = html_text(report(), kFacts);
  expect_balanced(text);
  EXPECT_NE(text.find("does not conform"), std::string::npos);
  EXPECT_EQ(count(text, "http"), 0);
  EXPECT_EQ(count(text, "<script"), 0);
  EXPECT_NE(text.find("Less &lt; more &amp; &quot;quoted&quot;."), std::string::npos);
  EXPECT_NE(text.find("&gt; 00 01\n&lt; 02"), std::string::npos);
  EXPECT_NE(text.find("FRAME-1"), std::string::npos);
  RunReport passed = report();
  passed.results.erase(passed.results.begin() + 1);
  EXPECT_EQ(count(html_text(passed, kFacts), "does not conform"), 0);
}

}  // namespace
}  // namespace kaz::hil
