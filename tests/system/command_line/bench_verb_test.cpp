// `kaz bench` as a user runs it: on the virtual stand, on the pty of `kaz sim --stand`, and its errors.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using std::chrono::seconds;
using Json = nlohmann::json;

Json measurement(const Json& report, const std::string& name) {
  for (const Json& one : report["measurements"]) {
    if (one["name"] == name) return one;
  }
  ADD_FAILURE() << "there is no " << name;
  return {};
}

TEST(BenchVerb, MotorLeavesItsReportsAndFitReadsThem) {
  const TemporaryFolder folder;
  const std::string out = folder / "motor";
  const Finished bench = run(kaz({"bench", "motor", "--mcu", "native", "--out", out}), seconds(60));
  ASSERT_EQ(bench.exit_code, 0) << bench.out << bench.err;
  EXPECT_NE(bench.out.find("26 passed, 0 failed, 0 left out, 0 undecided"), std::string::npos)
      << bench.out;
  EXPECT_NE(bench.err.find("100 %"), std::string::npos) << bench.err;
  for (const char* file : {"report.html", "result.json", "measurements.csv", "curves.csv",
                           "junit.xml", "plots/l_sh_pitch-stall.svg"})
    EXPECT_GT(std::filesystem::file_size(out + "/" + file), 500u) << file;
  const Json report = Json::parse(read_file(out + "/result.json"));
  EXPECT_EQ(report["seed"], 1);
  EXPECT_NEAR(measurement(report, "stall.torque_10v")["value"].get<double>(), 2.16, 0.03 * 2.16);
  EXPECT_NEAR(measurement(report, "stall.torque_4v8")["value"].get<double>(), 0.97, 0.03 * 0.97);

  const std::string fitted = folder / "fit";
  const Finished fit =
      run(kaz({"bench", "fit", out, "--mcu", "native", "--out", fitted, "--json"}), seconds(120));
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const Json result = Json::parse(fit.out);
  for (const auto& [name, figure] : result["measurements"].items()) {
    EXPECT_TRUE(figure["measured"].get<bool>()) << name;
    EXPECT_NEAR(figure["after"].get<double>(), figure["before"].get<double>(),
                0.1 * figure["before"].get<double>())
        << name;
  }
  // When and by which command, as in every other report.
  const std::string date = result["provenance"]["date"];
  const std::string page = read_file(fitted + "/report.html");
  EXPECT_NE(page.find("<br>" + date + ", "), std::string::npos) << page.substr(0, 3000);
  EXPECT_NE(page.find("<code>kaz bench fit "), std::string::npos) << page.substr(0, 3000);
  EXPECT_NE(read_file(fitted + "/motor.xml").find("Fitted " + date), std::string::npos);
  const Finished again =
      run(kaz({"bench", "motor", "--mcu", "native", "--motor-file", fitted + "/motor.xml",
               "--filter", "pot.noise", "--out", folder / "again"}),
          seconds(60));
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST(BenchVerb, AFailedLimitIsReported) {
  const TemporaryFolder folder;
  write_file(folder / "limits.json", R"({"pot.noise": {"high": 0.1}})");
  const Finished bench = run(kaz({"bench", "motor", "--mcu", "native", "--filter", "pot.noise",
                                  "--limits", folder / "limits.json", "--out", folder / "out"}),
                             seconds(60));
  EXPECT_EQ(bench.exit_code, 1) << bench.err;
  EXPECT_NE(bench.out.find("is above the limit of 0.1 codes"), std::string::npos) << bench.out;
}

TEST(BenchVerb, LinkAndTickOfTheFirmware) {
  const TemporaryFolder folder;
  for (const char* what : {"link", "tick"}) {
    const Finished bench =
        run(kaz({"bench", what, "--json", "--out", folder / "out"}), seconds(100));
    ASSERT_EQ(bench.exit_code, 0) << bench.out << bench.err;
    EXPECT_GT(Json::parse(bench.out)["measurements"].size(), 4u);
  }
}

// Redirected: what is done shows from the start, and a measurement when it is made, not at the end of all.
TEST(BenchVerb, SaysHowFarItIsInAPipe) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--stand", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  Process bench(kaz({"bench", "link", "--port", folder / "board", "--out", folder / "out"}));
  EXPECT_TRUE(bench.wait_for_output("0 %  round trips", seconds(20)));
  EXPECT_TRUE(bench.wait_for_output("link.cycle_rate", seconds(120)));
  bench.signal(SIGINT);  // the telemetry has ten seconds still to go
  const Finished done = bench.wait(seconds(20));
  EXPECT_EQ(done.exit_code, 128 + SIGINT) << done.out << done.err;
  EXPECT_NE(done.err.find("60 %  control cycles"), std::string::npos) << done.err;
}

// The same torque over a real pty, the tools worked by the control socket.
TEST(BenchVerb, StandBehindAPort) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--stand", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  const std::vector<std::string> at_port{"bench",          "motor",    "--port",
                                         folder / "board", "--json",   "--out",
                                         folder / "out",   "--filter", "stall.torque_10v"};
  auto with_stand = at_port;
  with_stand.insert(with_stand.end(), {"--stand", "ctl:" + (folder / "board.ctl")});
  const Finished bench = run(kaz(with_stand), seconds(120));
  ASSERT_EQ(bench.exit_code, 0) << bench.out << bench.err;
  const Json report = Json::parse(bench.out);
  EXPECT_NEAR(measurement(report, "stall.torque_10v")["value"].get<double>(), 2.16, 0.03 * 2.16);
  EXPECT_EQ(report["port"], folder / "board");
  EXPECT_FALSE(report.contains("seed")) << "a board at a port has none";

  const Finished constrained = run(kaz(at_port), seconds(60));
  EXPECT_EQ(constrained.exit_code, 2);
  for (const char* part : {"if the motor is on a motor stand, give --stand", "give --allow-motion"})
    EXPECT_NE(constrained.err.find(part), std::string::npos) << constrained.err;
  auto allowed = at_port;
  allowed.push_back("--allow-motion");
  const Finished alone = run(kaz(allowed), seconds(60));
  EXPECT_EQ(alone.exit_code, 1) << "nothing measured is no success";
  EXPECT_NE(alone.err.find("no measurement was made"), std::string::npos) << alone.err;
  const Json left = measurement(Json::parse(alone.out), "stall.torque_10v");
  EXPECT_EQ(left["verdict"], "left out");
  EXPECT_EQ(left["message"],
            "this measurement needs a motor stand: give --stand ctl:PATH or --stand manual");

  auto manual = at_port;
  manual.insert(manual.end(), {"--stand", "manual"});
  const Finished nobody = run(kaz(manual), seconds(60));
  EXPECT_EQ(nobody.exit_code, 2) << nobody.err;
  EXPECT_NE(nobody.err.find("needs somebody at the keyboard"), std::string::npos) << nobody.err;
}

TEST(BenchVerb, ErrorsSayWhatToDo) {
  const TemporaryFolder folder;
  const struct {
    std::vector<std::string> arguments;
    int status;
    const char* says;
  } cases[] = {
      {{"motor", "--joint", "l_foot"}, 2, "there is no joint `l_foot`"},
      {{"motor", "--joint", "neck_pan,neck_pan"}, 2, "names `neck_pan` twice"},
      {{"motor", "--stand", "manual"}, 2, "--stand is only valid with --robot"},
      {{"motor", "--limits", folder / "none.json"},
       2,
       "cannot be read (No such file or directory)"},
      {{"motor", "--filter", "wings", "--mcu", "native"}, 2, "matches no measurement of a motor"},
      {{"motor", "--port", folder / "none", "--allow-motion"}, 3, "none"},
      {{"motor", "--motor", "v8", "--mcu", "native"}, 2, "v8"},
      {{"fit", folder / "none"}, 2, "cannot be read (No such file or directory)"},
      {{"link", "--mcu", "native", "--port", "x"}, 2, "--robot"},
      {{"motor", "--motor-file", "x", "--port", "x"}, 2, "--motor-file"},
  };
  for (const auto& one : cases) {
    std::vector<std::string> arguments{"bench"};
    arguments.insert(arguments.end(), one.arguments.begin(), one.arguments.end());
    if (one.arguments[0] != "fit") {
      arguments.push_back("--out");
      arguments.push_back(folder / "out");
    }
    const Finished bench = run(kaz(arguments), seconds(60));
    EXPECT_EQ(bench.exit_code, one.status) << one.says << "\n" << bench.err;
    EXPECT_NE(bench.err.find(one.says), std::string::npos) << bench.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out")) << "nothing was measured";
  // A robot is no stand, and says so before anything moves.
  Process sim(kaz({"sim", "--world", "empty", "--mcu", "native", "--serial", folder / "robot"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished robot = run(kaz({"bench", "motor", "--port", folder / "robot", "--stand",
                                  "ctl:" + (folder / "robot.ctl"), "--out", folder / "out"}),
                             seconds(60));
  EXPECT_EQ(robot.exit_code, 3);
  EXPECT_NE(robot.err.find("this is a robot, not a motor stand"), std::string::npos) << robot.err;
}

}  // namespace
}  // namespace kaz::test
