// `kaz sim --bus` with clients over its pty: the example in Python, wrong usage, and how it ends.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using std::chrono::seconds;

const std::string kArm = "sim/robots/so101/so101.urdf";

std::vector<std::string> simulator(const std::string& port) {
  return kaz({"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", port});
}

TEST(ServoBusVerb, ServesTheExampleInPython) {
  const TemporaryFolder folder;
  const std::string port = folder / "arm";
  Process sim(simulator(port));
  ASSERT_TRUE(sim.wait_for_output("ready: 6 servos", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished waved = run({KAZ_PYTHON, "-B", "examples/python/servo_arm.py", port});
  EXPECT_EQ(waved.exit_code, 0) << waved.out << waved.err;
  EXPECT_NE(waved.out.find("servo 6: 7.4 V"), std::string::npos) << waved.out;
  EXPECT_NE(waved.out.find("lost or damaged: 0"), std::string::npos) << waved.out;
  sim.signal(SIGINT);
  const Finished ended = sim.wait(seconds(10));
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NE(ended.out.find("host talks at 1000000 baud"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("lost 0;"), std::string::npos) << ended.out;
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(port)));
  EXPECT_FALSE(std::filesystem::exists(port + ".ctl"));
}

TEST(ServoBusVerb, ServesDynamixelsToTheExampleInPython) {
  const TemporaryFolder folder;
  const std::string port = folder / "mini";
  Process sim(kaz({"sim", "--bus", "dynamixel", "--robot-file", "sim/robots/mini/mini.urdf",
                   "--serial", port, "--suspended"}));
  ASSERT_TRUE(sim.wait_for_output("ready: 18 servos", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished nodded = run({KAZ_PYTHON, "-B", "examples/python/servo_humanoid.py", port});
  EXPECT_EQ(nodded.exit_code, 0) << nodded.out << nodded.err;
  EXPECT_NE(nodded.out.find("18 servos, 5.0 V"), std::string::npos) << nodded.out;
  EXPECT_NE(nodded.out.find("lost or damaged: 0"), std::string::npos) << nodded.out;
  // At another rate nobody answers.
  const Finished silent = run({KAZ_PYTHON, "-B", "examples/python/servo_humanoid.py", port,
                               "--baud", "115200", "--ids", "1-5"});
  EXPECT_EQ(silent.exit_code, 3) << silent.out;
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

TEST(ServoBusVerb, RefusesWhatABusDoesNotHave) {
  const TemporaryFolder folder;
  const std::string port = folder / "arm";
  const std::pair<std::vector<std::string>, const char*> wrong[] = {
      {{"sim", "--bus", "feetech", "--serial", port}, "--robot-file is missing"},
      {{"sim", "--bus", "feetech", "--robot-file", kArm}, "--serial is missing"},
      {{"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", port, "--mcu", "native"},
       "--mcu: a servo bus has no use for it"},
      {{"sim", "--bus", "feetech", "--robot-file", kArm, "--serial", port, "--stand"},
       "--stand: a servo bus has no use for it"},
      {{"sim", "--bus", "feetech", "--robot-file", "sim/robots/arm/arm.urdf", "--serial", port},
       "sim/robots/arm/bus.json"},
      {{"sim", "--bus", "dynamixel", "--robot-file", kArm, "--serial", port},
       "has servos of the protocol feetech"},
      {{"sim", "--bus", "can", "--robot-file", kArm, "--serial", port}, "--bus"}};
  for (const auto& [arguments, reason] : wrong) {
    const Finished finished = run(kaz(arguments));
    EXPECT_EQ(finished.exit_code, 2) << reason;
    EXPECT_NE(finished.err.find(reason), std::string::npos) << finished.err;
    EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(port))) << reason;
  }
}

}  // namespace
}  // namespace kaz::test
