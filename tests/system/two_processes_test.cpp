// The virtual robot in one process, the behaviour in another, a real pty between them, in real
// time.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/process.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::seconds;

std::vector<std::string> simulator(const TemporaryFolder& folder, const std::string& engine) {
  return kaz({"sim", "--world", "ball", "--mcu", engine, "--serial", folder / "board", "--cameras",
              folder / "eyes"});
}

std::vector<std::string> behaviour(const TemporaryFolder& folder, const std::string& duration) {
  return kaz({"run", "track-ball", "--robot", "serial:" + (folder / "board"), "--camera",
              folder / "eyes", "--duration", duration, "--out", folder / "out"});
}

bool ready(Process& sim) {
  return sim.wait_for_output("ready", seconds(30));
}

class Engines : public ::testing::TestWithParam<const char*> {};

TEST_P(Engines, BehaviourRunsOverThePty) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, GetParam()));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  const Finished finished = run(behaviour(folder, "14"), seconds(60));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  const json result = json::parse(read_file(folder / "out/result.json"), nullptr, false);
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result["outcome"], "done");
  EXPECT_GT(result["found_s"].get<double>(), 0);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "board"));
  EXPECT_FALSE(std::filesystem::exists(folder / "eyes"));
}

INSTANTIATE_TEST_SUITE_P(Both, Engines, ::testing::Values("h8", "native"));

TEST(TwoProcesses, SimulatorKilledLeavesTheBehaviourWithAClearMessage) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "native"));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  Process run(behaviour(folder, "60"));
  ASSERT_TRUE(run.wait_for_output("search", seconds(20))) << run.wait(seconds(0)).err;
  sim.signal(SIGKILL);
  const Finished finished = run.wait(seconds(10));
  EXPECT_EQ(finished.exit_code, 3) << finished.err;
  EXPECT_NE(finished.err.find(folder / "board"), std::string::npos) << finished.err;
}

TEST(TwoProcesses, BehaviourKilledLeavesTheMotorsOff) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "h8"));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  Process run(behaviour(folder, "60"));
  ASSERT_TRUE(sim.wait_for_output("motors on", seconds(20))) << sim.wait(seconds(0)).err;
  run.signal(SIGKILL);
  EXPECT_TRUE(sim.wait_for_output("motors off", seconds(10))) << sim.wait(seconds(0)).err;
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

TEST(TwoProcesses, BoardThatStopsAnsweringIsNoticed) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "native"));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  Process run(behaviour(folder, "60"));
  ASSERT_TRUE(run.wait_for_output("search", seconds(20))) << run.wait(seconds(0)).err;
  sim.signal(SIGSTOP);
  const Finished finished = run.wait(seconds(15));
  sim.signal(SIGCONT);
  EXPECT_EQ(finished.exit_code, 3) << finished.err;
  EXPECT_NE(finished.err.find("answer"), std::string::npos) << finished.err;
}

}  // namespace
}  // namespace kaz::test
