// Every seed of the targets of targets.h, damaged seeds, and noise, as ordinary tests; and inputs that are
// too long for a seed.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/body/description/robot_model.h"
#include "sim/body/description/world_model.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/fuzz/seeds_test.h"

namespace kaz::fuzz {
namespace {

INSTANTIATE_TEST_SUITE_P(Inputs, Seeds, testing::ValuesIn(kInputTargets),
                         [](const auto& of) { return std::string(of.param.name); });

std::string file_of(const std::string& text, const std::string& name) {
  return input_file({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, name);
}

// Parser and dynamics recurse once a link.
TEST(LongInputs, ChainOfLinksIsRefused) {
  const std::string inertial =
      "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
      "izz='1'/></inertial>";
  std::string text = "<robot name='chain'><link name='l0'>" + inertial + "</link>";
  for (int k = 1; k < 20'000; ++k) {
    const std::string n = std::to_string(k);
    text += "<link name='l" + n + "'>" + inertial + "</link><joint name='j" + n +
            "' type='revolute'><parent link='l" + std::to_string(k - 1) + "'/><child link='l" + n +
            "'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  }
  const auto robot = sim::load_robot(file_of(text + "</robot>", "chain.urdf"));
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.error().message.find("more than 500 links"), std::string::npos)
      << robot.error().message;
}

// The parser's time grows with the square of their number.
TEST(LongInputs, WorldOfManyModelsIsRefused) {
  std::string text = "<sdf version='1.9'><world name='w'>";
  for (int k = 0; k < 20'000; ++k)
    text +=
        "<model name='m" + std::to_string(k) + "'><static>true</static><link name='l'/></model>";
  const auto world = sim::load_world(file_of(text + "</world></sdf>", "models.sdf"));
  ASSERT_FALSE(world);
  EXPECT_NE(world.error().message.find("more than 4000 models"), std::string::npos)
      << world.error().message;
}

TEST(LongInputs, FileOfManyMegabytesIsRefused) {
  const std::string text = "<robot>" + std::string(17 << 20, ' ') + "</robot>";
  const auto robot = sim::load_robot(file_of(text, "blank.urdf"));
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.error().message.find("more than 16 MB"), std::string::npos)
      << robot.error().message;
}

}  // namespace
}  // namespace kaz::fuzz
