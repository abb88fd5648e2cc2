// The example client in Python against the virtual robot, over a pty, as a user would run it.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>

#include <gtest/gtest.h>

#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using std::chrono::seconds;

std::vector<std::string> client(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {KAZ_PYTHON, "examples/python/kaz_client.py"});
  return arguments;
}

class PythonClient : public ::testing::TestWithParam<const char*> {};

TEST_P(PythonClient, MovesAJointReadsItBackAndHandlesARefusal) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--world", "ball", "--mcu", GetParam(), "--serial", folder / "board",
                   "--cameras", folder / "eyes"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished finished = run(client({folder / "board", "--joint", "0", "--angle", "0.3"}));
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  for (const char* text : {"18 joints, protocol 2", "joint 0 is on at", "joint 0 is at +0.",
                           "outside the joint's soft limits, joint 0", "all joints are off"})
    EXPECT_NE(finished.out.find(text), std::string::npos) << text << "\n" << finished.out;

  // A target that the joint cannot have is the same refusal, now as the result.
  const Finished refused = run(client({folder / "board", "--joint", "12", "--angle", "-1"}));
  EXPECT_EQ(refused.exit_code, 1) << refused.out << refused.err;
  EXPECT_NE(refused.err.find("outside the joint's soft limits, joint 12"), std::string::npos)
      << refused.err;
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Both, PythonClient, ::testing::Values("h8", "native"));

TEST(PythonClientAlone, SaysWhatIsWrong) {
  const Finished no_port = run(client({"/nowhere/board"}));
  EXPECT_EQ(no_port.exit_code, 3);
  EXPECT_NE(no_port.err.find("/nowhere/board"), std::string::npos) << no_port.err;
  EXPECT_EQ(run(client({"/nowhere/board", "--joint", "18"})).exit_code, 2);
  EXPECT_EQ(run(client({"--help"})).exit_code, 0);
}

}  // namespace
}  // namespace kaz::test
