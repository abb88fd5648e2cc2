// The example behaviour works, and docs/tutorial/own-behavior.md prints it as it is compiled.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "host/behavior/behavior.h"
#include "host/robot/robot_testing.h"

namespace kaz::behavior {

extern const Behavior kNod;
namespace {

std::string contents(const char* path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(NodExample, Nods) {
  host::TestBoard board;
  host::Robot robot = host::connect_to(board);
  Recording recording;
  Context context{robot, board, nullptr, recording,
                  *OptionValues::parse(kNod.options, {{"times", "1"}})};
  const auto outcome = kNod.run(context);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(outcome->success);
  EXPECT_NEAR(outcome->measurements.at(0).second, 0.3, 0.02);
  EXPECT_NEAR(board.angles_at(board.now())[host::neck_tilt], 0, 0.02);
}

// The arm's second joint is on the channel of neck_tilt: it must not nod instead.
TEST(NodExample, RefusesARobotWithoutItsJoint) {
  host::TestBoard board;
  host::Robot robot = host::connect_to(board);
  Recording recording;
  Context context{robot, board, nullptr, recording, *OptionValues::parse(kNod.options, {})};
  context.other_joints = {"turn", "shoulder"};
  const auto outcome = kNod.run(context);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().fault, Fault::usage);
  EXPECT_EQ(outcome.error().message,
            "nod moves neck_tilt, and this robot has only turn, shoulder; use a behaviour that is "
            "written for these, or `stand`");
  EXPECT_FALSE(board.motors_on());
}

TEST(NodExample, IsTheOneInTheDocumentation) {
  const std::string code = contents("host/behavior/nod_example.cpp");
  ASSERT_FALSE(code.empty());
  EXPECT_NE(contents("docs/tutorial/own-behavior.md").find("```cpp\n" + code + "```"),
            std::string::npos)
      << "copy host/behavior/nod_example.cpp into docs/tutorial/own-behavior.md";
}

}  // namespace
}  // namespace kaz::behavior
