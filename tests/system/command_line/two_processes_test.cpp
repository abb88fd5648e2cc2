// The virtual robot in one process, the behavior in another, a real pty between them, in real
// time.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <csignal>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/link/tty_link.h"
#include "host/link/wall_clock.h"
#include "host/robot/robot.h"
#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::seconds;

std::vector<std::string> simulator(const TemporaryFolder& folder, const std::string& engine) {
  return kaz({"sim", "--world", "ball", "--mcu", engine, "--serial", folder / "board", "--cameras",
              folder / "eyes"});
}

std::vector<std::string> behavior(const TemporaryFolder& folder, const std::string& duration) {
  return kaz({"run", "track-ball", "--robot", "serial:" + (folder / "board"), "--camera",
              folder / "eyes", "--duration", duration, "--out", folder / "out"});
}

bool ready(Process& sim) {
  return sim.wait_for_output("ready", seconds(30));
}

class Engines : public ::testing::TestWithParam<const char*> {};

TEST_P(Engines, BehaviorRunsOverThePty) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, GetParam()));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  const Finished finished = run(behavior(folder, "14"), seconds(60));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  const json result = parse_json(read_file(folder / "out/result.json"));
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result["outcome"], "done");
  EXPECT_GT(result["found_s"].get<double>(), 0);
  // Not the run's own doing, as at its end, where it measured for too long with the motors on.
  const json& lateness = result["lateness"];
  if (lateness.value("host_worst_late_s", 1.0) < 0.05 &&
      lateness.value("simulator_lost_s", 1.0) == 0) {
    EXPECT_EQ(finished.err.find("answered again"), std::string::npos)
        << "the link watchdog expired: " << finished.err;
    EXPECT_EQ(finished.err.find("the link was lost"), std::string::npos) << finished.err;
  }
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "board"));
  EXPECT_FALSE(std::filesystem::exists(folder / "eyes"));
}

// An emergency button that always sends the same bytes, beside a host that enables. At most three requests
// are between two presses, so a board that answers repetitions from memory would know each.
TEST_P(Engines, TheSameStopFrameStopsEachTime) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, GetParam()));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  host::WallClock clock;
  auto link = host::TtyLink::open(folder / "board");
  ASSERT_TRUE(link) << link.error().message;
  auto robot = host::Robot::connect(**link, clock, {.watchdog = seconds(1)});
  ASSERT_TRUE(robot) << robot.error().message;
  for (const u8 address : {KZ_ADDRESS_DEFAULT, KZ_ADDRESS_ALL}) {
    const u8 body[] = {address, KZ_TYPE_stop, 0};
    std::array<u8, KZ_FRAME_MAX> wire{};
    const u8 length = kz_frame_encode(body, sizeof body, wire.data());
    for (int press = 0; press < 3; ++press) {
      ASSERT_TRUE(robot->enable(host::kAllJoints));
      ASSERT_TRUE((*link)->write({wire.data(), length}));
      const auto posture = robot->state();
      ASSERT_TRUE(posture) << posture.error().message;
      EXPECT_FALSE(posture->status & KZ_STATUS_ENABLED) << int(address) << ", press " << press;
      EXPECT_EQ(posture->status >> 8, KZ_SHUTDOWN_STOP);
    }
  }
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Both, Engines, ::testing::Values("h8", "native"));

// As in lockstep (cli_test.cpp), from the file that a real robot's user gives as well.
TEST(TwoProcesses, JointsOfAnotherRobotComeFromItsFile) {
  const std::string arm = "sim/robots/arm/arm.urdf";
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--world", "empty", "--robot-file", arm, "--mcu", "native", "--serial",
                   folder / "board"}));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  const auto stand = [&](const std::string& posture) {
    return run(kaz({"run", "stand", "--set", "posture=" + posture, "--robot-file", arm, "--robot",
                    "serial:" + (folder / "board")}),
               seconds(60));
  };
  const Finished kazs = stand("home");
  EXPECT_EQ(kazs.exit_code, 2) << kazs.err;
  EXPECT_NE(kazs.err.find("this robot has the joints turn, "), std::string::npos) << kazs.err;
  const Finished own = stand("keep");
  EXPECT_EQ(own.exit_code, 0) << own.err;
  EXPECT_EQ(own.out.find("neck"), std::string::npos) << own.out;
}

TEST(TwoProcesses, SimulatorKilledLeavesTheBehaviorWithAClearMessage) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "native"));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  Process run(behavior(folder, "60"));
  ASSERT_TRUE(run.wait_for_output("search", seconds(20))) << run.wait(seconds(0)).err;
  sim.signal(SIGKILL);
  const Finished finished = run.wait(seconds(15));
  EXPECT_EQ(finished.exit_code, 3) << finished.err;
  EXPECT_NE(finished.err.find(folder / "board"), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find("round trip on " + (folder / "board") + ": "), std::string::npos)
      << finished.err;
  const std::string words = "; the last frames are in ";
  const auto named = finished.err.find(words);
  ASSERT_NE(named, std::string::npos) << finished.err;
  const auto from = named + words.size();
  const std::string path = finished.err.substr(from, finished.err.find("; ", from) - from);
  EXPECT_NE(read_file(path).find("state_reply"), std::string::npos) << path;
  std::filesystem::remove(path);
}

// What the link watchdog does is the host's choice, and that of the library is to hold.
TEST(TwoProcesses, BehaviorKilledLeavesTheRobotHoldingForTheNext) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "h8"));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  Process run(behavior(folder, "60"));
  ASSERT_TRUE(sim.wait_for_output("motors on", seconds(20))) << sim.wait(seconds(0)).err;
  run.signal(SIGKILL);
  run.wait(seconds(10));
  {
    host::WallClock clock;
    ASSERT_TRUE(clock.sleep_until(clock.now() + std::chrono::milliseconds(500)));
    auto link = host::TtyLink::open(folder / "board");
    ASSERT_TRUE(link) << link.error().message;
    auto robot = host::Robot::connect(**link, clock, {.watchdog = Time(0)});
    ASSERT_TRUE(robot) << robot.error().message;
    const unsigned status = robot->identity().status;
    EXPECT_EQ(status >> 8, unsigned{KZ_SHUTDOWN_LINK_LOST});
    EXPECT_TRUE(status & KZ_STATUS_HOLDING);
    const host::JointTarget target{host::neck_pan, 0.1};
    EXPECT_FALSE(robot->set_targets({&target, 1}, Time(0))) << "held: no target is taken";
    ASSERT_TRUE(robot->enable(host::kAllJoints));
    EXPECT_TRUE(robot->set_targets({&target, 1}, Time(0)));
    EXPECT_TRUE(robot->disable_all());
  }
  // Read from the emulated firmware's state.
  EXPECT_TRUE(sim.wait_for_output("s: by a host request or by a reset", seconds(10)))
      << sim.wait(seconds(0)).err;
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

TEST(TwoProcesses, ABrokenPotentiometerIsAFailureOfTheRobot) {
  const TemporaryFolder folder;
  write_file(folder / "pot", "at 0 s pot_open joint neck_pan\nat 900 s power_reset\n");
  Process sim(kaz({"sim", "--world", "empty", "--mcu", "native", "--serial", folder / "board",
                   "--faults", folder / "pot"}));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  const Finished finished = run(
      kaz({"run", "stand", "--robot", "serial:" + (folder / "board"), "--out", folder / "out"}));
  EXPECT_EQ(finished.exit_code, 1) << finished.err;
  const json result = parse_json(read_file(folder / "out/result.json"));
  ASSERT_TRUE(result.is_object()) << finished.err;
  EXPECT_EQ(result["outcome"], "failed");
  EXPECT_NE(result["sentence"].get<std::string>().find("potentiometer"), std::string::npos);
  EXPECT_TRUE(result.contains("link")) << "a whole result";
  sim.signal(SIGINT);
  const Finished ended = sim.wait(seconds(10));
  EXPECT_NE(
      ended.out.find("1 fault never began, because the run ended before it: at 900 s power_reset"),
      std::string::npos)
      << ended.out;
}

// There is no ball, so each run fails. Of one whose simulator lagged that proves nothing.
TEST(TwoProcesses, AFailureWhileTheSimulatorLagsIsTheMachines) {
  for (const bool lags : {true, false}) {
    SCOPED_TRACE(lags);
    const TemporaryFolder folder;
    Process sim(kaz({"sim", "--world", "empty", "--mcu", "native", "--eyes", "ideal", "--serial",
                     folder / "board", "--cameras", folder / "eyes"}));
    ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
    Process run(behavior(folder, "6"));
    ASSERT_TRUE(run.wait_for_output("search", seconds(20))) << run.wait(seconds(0)).err;
    for (int n = 0; lags && n < 8; ++n) {
      sim.signal(SIGSTOP);
      std::this_thread::sleep_for(std::chrono::milliseconds(250));
      sim.signal(SIGCONT);
      std::this_thread::sleep_for(std::chrono::milliseconds(250));
    }
    const Finished finished = run.wait(seconds(30));
    const json result = parse_json(read_file(folder / "out/result.json"));
    ASSERT_TRUE(result.is_object()) << finished.err;
    if (!result.contains("lateness")) {  // on a busy machine the run broke off
      EXPECT_EQ(result["outcome"], "environment") << result;
      EXPECT_EQ(finished.exit_code, 3) << finished.err;
      continue;
    }
    const json& lateness = result["lateness"];
    EXPECT_TRUE(lateness.contains("host_late_s") && lateness.contains("host_worst_late_s"));
    const double lost_s = lateness.value("simulator_lost_s", -1.0);
    if (lags) {
      EXPECT_EQ(finished.exit_code, 3) << finished.out << finished.err;
      EXPECT_EQ(result["outcome"], "environment");
      EXPECT_GT(lost_s, 1.5);
      EXPECT_NE(finished.err.find("fell behind by "), std::string::npos) << finished.err;
    } else if (lost_s < 0.5 && lateness["host_late_s"] < 0.5) {  // a busy machine lags by itself
      EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
      EXPECT_EQ(result["outcome"], "failed");
    }
  }
}

TEST(TwoProcesses, BoardThatStopsAnsweringIsNoticed) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "native"));
  ASSERT_TRUE(ready(sim)) << sim.wait(seconds(0)).err;
  Process run(behavior(folder, "60"));
  ASSERT_TRUE(run.wait_for_output("search", seconds(20))) << run.wait(seconds(0)).err;
  sim.signal(SIGSTOP);
  const Finished finished = run.wait(seconds(15));
  sim.signal(SIGCONT);
  EXPECT_EQ(finished.exit_code, 3) << finished.err;
  EXPECT_NE(finished.err.find("answer"), std::string::npos) << finished.err;
}

}  // namespace
}  // namespace kaz::test
