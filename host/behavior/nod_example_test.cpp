// The example works, and docs/howto/own-behavior.md prints it as it is compiled.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

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
            "nod moves neck_tilt, but this robot has only turn, shoulder; use a behavior for this "
            "robot's joints, or `stand`");
  EXPECT_FALSE(board.motors_on());
}

TEST(NodExample, IsTheOneInTheDocumentation) {
  const std::string code = contents("host/behavior/nod_example.cpp");
  ASSERT_FALSE(code.empty());
  EXPECT_NE(contents("docs/howto/own-behavior.md").find("```cpp\n" + code + "```"),
            std::string::npos)
      << "copy host/behavior/nod_example.cpp into docs/howto/own-behavior.md";
}

// The commands of the page in steps 1 and 2: its indented lines before step 3.
std::string copying_commands() {
  std::istringstream page(contents("docs/howto/own-behavior.md"));
  const std::string indent(7, ' ');
  std::string commands;
  for (std::string line; std::getline(page, line) && !line.starts_with("3. ");)
    if (line.starts_with(indent)) commands += line + "\n";
  return commands;
}

// Without a trace of the example, and formatted.
TEST(NodExample, IsCopiedAsTheDocumentationShows) {
  namespace fs = std::filesystem;
  const fs::path folder = testing::TempDir() + "kaz_my_nod_" + std::to_string(getpid());
  const fs::path copies = folder / "host/behavior";
  fs::create_directories(copies);
  for (const char* name : {"nod_example.cpp", "behaviors.def"})
    fs::copy_file(fs::path("host/behavior") / name, copies / name);
  const std::string commands = "set -e; cd '" + folder.string() + "'\n" + copying_commands();
  EXPECT_EQ(std::system(commands.c_str()), 0) << commands;
  const std::string code = contents((copies / "my_nod.cpp").c_str());
  const std::string list = contents((copies / "behaviors.def").c_str());
  fs::remove_all(folder);

  EXPECT_TRUE(code.starts_with("// my-nod: moves the head up and down.\n// SPDX-")) << code;
  for (const char* left : {"\n\n\n", "extern", "kNod", "\"nod\"", "example", "tutorial"})
    EXPECT_EQ(code.find(left), std::string::npos) << left << " in:\n" << code;
  EXPECT_NE(code.find("Behavior kMyNod{\n    .name = \"my-nod\", "), std::string::npos) << code;
  EXPECT_NE(list.find("\nKAZ_BEHAVIOR(my_nod, kMyNod)\nKAZ_BEHAVIOR(navigate"), std::string::npos)
      << list;
}

}  // namespace
}  // namespace kaz::behavior
