// `kaz conformance` as a user runs it: over a real pty, and its exit status.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <cstdlib>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::seconds;

class Ptys : public ::testing::TestWithParam<const char*> {};

// A case of each chapter; the whole suite takes two minutes in real time.
TEST_P(Ptys, ABoardBehindAPtyConforms) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--mcu", GetParam(), "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished finished =
      run(kaz({"conformance", "--port", folder / "board", "--allow-motion", "--filter",
               "^(frame.noise|frame.bad-check$|address.other-2$|request.repeated-not|reply|"
               "identity.identify|motion.target-reached|limits.joint-0$|settings.gains-read|"
               "safety.stop$|watchdog.hold$|calibration.set$|bench.reset$|safety.supply-low)",
               "--json", folder / "report.json", "--junit", folder / "report.xml", "--html",
               folder / "report.html"}),
          seconds(90));
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  const json report = parse_json(read_file(folder / "report.json"));
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["failed"], 0) << finished.out;
  EXPECT_GE(report["passed"], 25);
  EXPECT_EQ(report["left_out"], 1);  // the one that needs a bench
  EXPECT_EQ(report["port"], folder / "board");
  EXPECT_NE(read_file(folder / "report.xml").find("<testsuite"), std::string::npos);
  EXPECT_NE(read_file(folder / "report.html").find("conforms"), std::string::npos);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Both, Ptys, ::testing::Values("h8", "native"));

// The machine's failure, and neither the board's nor its protocol's.
class StoppedSimulator : public ::testing::Test {
 protected:
  StoppedSimulator() {
    setenv("XDG_STATE_HOME", folder_.path().c_str(), 1);
    EXPECT_TRUE(sim_.wait_for_output("ready", seconds(30))) << sim_.wait(seconds(0)).err;
  }
  std::string port() const { return folder_ / "board"; }
  // Three times, while `program` goes on.
  void stop_and_continue(Process& program) {
    for (int n = 0; n < 3; ++n) {
      sim_.signal(SIGSTOP);
      (void)program.prints_within("never printed", seconds(1));
      sim_.signal(SIGCONT);
      (void)program.prints_within("never printed", seconds(1));
    }
  }

  TemporaryFolder folder_;
  Process sim_{kaz({"sim", "--mcu", "native", "--world", "empty", "--serial", port()})};
};

TEST_F(StoppedSimulator, FailsNoCaseOfTheSuite) {
  Process suite(kaz({"conformance", "--port", port(), "--filter", "^(frame|request|address)",
                     "--json", folder_ / "report.json"}));
  ASSERT_TRUE(suite.wait_for_output("passed", seconds(30)));
  stop_and_continue(suite);
  const Finished end = suite.wait(seconds(90));
  EXPECT_TRUE(end.exit_code == 0 || end.exit_code == 3) << end.exit_code << end.out << end.err;
  const json report = parse_json(read_file(folder_ / "report.json"));
  ASSERT_TRUE(report.is_object()) << end.err;
  EXPECT_EQ(report["failed"], 0) << end.out;
  EXPECT_GE(report["passed"], 10);
}

TEST_F(StoppedSimulator, FailsNoCaseOfTheFuzzer) {
  Process fuzz(kaz(
      {"fuzz", "--target", port(), "--allow-motion", "--seconds", "8", "--out", folder_ / "case"}));
  ASSERT_TRUE(fuzz.wait_for_output("kaz fuzz", seconds(30)));
  stop_and_continue(fuzz);
  const Finished end = fuzz.wait(seconds(90));
  EXPECT_TRUE(end.exit_code == 0 || end.exit_code == 3) << end.exit_code << end.out << end.err;
}

// Whether it failed is then not known; what was tried before is reported all the same.
TEST_F(StoppedSimulator, WhereTheFuzzerIsInterruptedOrGivesUpItReportsWhatItTried) {
  for (const int number : {SIGINT, SIGTERM, 0}) {
    SCOPED_TRACE(number);
    Process fuzz(kaz({"fuzz", "--target", port(), "--allow-motion", "--seconds", "60", "--json",
                      "--out", folder_ / "case"}));
    (void)fuzz.prints_within("never printed", seconds(6));
    sim_.signal(SIGSTOP);
    if (number != 0) {
      (void)fuzz.prints_within("never printed", seconds(2));  // now it waits for a reply
      fuzz.signal(number);
    }
    (void)fuzz.prints_within("not decided", seconds(number == 0 ? 12 : 1));
    sim_.signal(SIGCONT);
    const Finished end = fuzz.wait(seconds(30));
    EXPECT_EQ(end.exit_code, number == 0 ? 3 : 128 + number) << end.out << end.err;
    const json result = parse_json(end.out);
    ASSERT_TRUE(result.is_object()) << end.out << end.err;
    EXPECT_GT(result["cases"], 0) << result;
    if (number == 0) {
      EXPECT_TRUE(result["ok"].is_null()) << result;
      // Stopped during a case, or before the next one.
      const std::string error = result.value("error", "");
      EXPECT_TRUE(error.find("not decided") != std::string::npos ||
                  error.find("no board answers on") != std::string::npos)
          << result;
    } else {
      EXPECT_EQ(result.value("interrupted", false), true) << result;
      EXPECT_NE(end.err.find("interrupted after "), std::string::npos) << end.err;
    }
  }
}

TEST_F(StoppedSimulator, ThatStaysStoppedIsALoss) {
  Process suite(kaz({"conformance", "--port", port(), "--filter", "^(frame|request|address)",
                     "--json", folder_ / "report.json"}));
  ASSERT_TRUE(suite.wait_for_output("passed", seconds(30)));
  sim_.signal(SIGSTOP);
  const Finished end = suite.wait(seconds(60));
  sim_.signal(SIGCONT);
  EXPECT_EQ(end.exit_code, 3) << end.out << end.err;
  EXPECT_NE(end.err.find("because that program is stopped or has ended; case "), std::string::npos)
      << end.err;
  EXPECT_NE(end.err.find("kaz recover --robot serial:" + port()), std::string::npos) << end.err;
  const json report = parse_json(read_file(folder_ / "report.json"));
  ASSERT_TRUE(report.is_object()) << end.err;
  EXPECT_EQ(report["failed"], 0) << end.out;
}

TEST_F(StoppedSimulator, InterruptedMeanwhileTheRunCountsAsInterrupted) {
  Process suite(kaz({"conformance", "--port", port(), "--filter", "^(frame|request|address)",
                     "--json", folder_ / "report.json"}));
  ASSERT_TRUE(suite.wait_for_output("passed", seconds(30)));
  sim_.signal(SIGSTOP);
  suite.signal(SIGINT);
  const Finished end = suite.wait(seconds(60));
  sim_.signal(SIGCONT);
  EXPECT_EQ(end.exit_code, 130) << end.out << end.err;
  EXPECT_NE(end.err.find("kaz recover --robot serial:" + port()), std::string::npos) << end.err;
  const json report = parse_json(read_file(folder_ / "report.json"));
  ASSERT_TRUE(report.is_object()) << end.err;
  EXPECT_EQ(report.value("interrupted", false), true) << report;
  EXPECT_EQ(report.value("signal", ""), "SIGINT");
  EXPECT_FALSE(report.value("board", "").empty());
}

TEST(ConformanceVerb, WithoutReportsAnInterruptNamesNone) {
  Process suite(kaz({"conformance", "--virtual", "h8"}));
  ASSERT_TRUE(suite.wait_for_output("passed", seconds(30)));
  suite.signal(SIGINT);
  const Finished end = suite.wait(seconds(10));
  EXPECT_EQ(end.exit_code, 130) << end.err;
  EXPECT_NE(end.err.find("interrupted after "), std::string::npos) << end.err;
  EXPECT_EQ(end.err.find("report"), std::string::npos) << end.err;
}

TEST(ConformanceVerb, ListsItsCases) {
  const Finished listed = run(kaz({"conformance", "--list", "--filter", "SAFE-5"}));
  EXPECT_EQ(listed.exit_code, 0);
  EXPECT_NE(listed.out.find("watchdog.default"), std::string::npos);
  EXPECT_EQ(listed.out.find("\nframe."), std::string::npos);
  const Finished as_json = run(kaz({"conformance", "--list", "--json", "--filter", "SAFE-5"}));
  const json cases = parse_json(as_json.out);
  ASSERT_TRUE(cases.is_array()) << as_json.out << as_json.err;
  EXPECT_FALSE(cases.at(0)["sentence"].get<std::string>().empty());
  EXPECT_TRUE(cases.at(0)["needs"].is_array());
}

TEST(ConformanceVerb, WrongUsageIsTwoAndNoPortIsThree) {
  EXPECT_EQ(run(kaz({"conformance"})).exit_code, 2);
  EXPECT_EQ(run(kaz({"conformance", "--virtual", "z80"})).exit_code, 2);
  EXPECT_EQ(run(kaz({"conformance", "--virtual", "native", "--filter", "("})).exit_code, 2);
  EXPECT_EQ(run(kaz({"conformance", "--virtual", "native", "--port", "/dev/null"})).exit_code, 2);
  EXPECT_EQ(run(kaz({"conformance", "--list", "--html", "page.html"})).exit_code, 2);
  EXPECT_EQ(run(kaz({"conformance", "--port", "/no/such/port"})).exit_code, 3);
  // No case taken, and none of those taken can run: nothing would be examined.
  for (const auto& [filter, why] :
       {std::pair("no such case", "matches no case"),
        std::pair("^timing.after-power-on$",
                  "no case that --filter ^timing.after-power-on$ selects "
                  "can run here")}) {
    const Finished none = run(kaz({"conformance", "--port", "/no/such/port", "--filter", filter}));
    EXPECT_EQ(none.exit_code, 2) << none.err;
    EXPECT_NE(none.err.find(why), std::string::npos) << none.err;
  }
}

TEST(ConformanceVerb, VirtualBoardsReportJsonOnStandardOutput) {
  const Finished finished =
      run(kaz({"conformance", "--virtual", "native", "--filter", "^frame", "--json", "-"}));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  const json report = parse_json(finished.out);
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["left_out"], 0);
  const Finished flag =
      run(kaz({"conformance", "--json", "--virtual", "native", "--filter", "^frame"}));
  EXPECT_TRUE(parse_json(flag.out).is_object()) << flag.out << flag.err;
}

}  // namespace
}  // namespace kaz::test
