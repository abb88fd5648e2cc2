// The module with the reader of worlds: the reader of this build, and modules that are not loaded.
// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/world_module.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace kaz::tools {
namespace {

// By load_world(), as the program: world_loader.cpp is linked with this test.
TEST(WorldModule, ReadsWorlds) {
  const auto world = sim::load_world("sim/worlds/boxes.sdf");
  ASSERT_TRUE(world) << world.error().message;
  EXPECT_GT(world->bodies.size(), 3u);
  const auto missing = sim::load_world("/none/world.sdf");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("/none/world.sdf"), std::string::npos)
      << missing.error().message;
}

TEST(WorldModule, IsRefusedWithItsPathAndTheReason) {
  const std::string text = testing::TempDir() + "text_" + std::to_string(getpid()) + ".so";
  std::ofstream(text) << "no module\n";
  for (const auto& [path, reason] :
       {std::pair<std::string, std::string>{"/none/world_reader.so", "No such file"},
        {text, "too short"},
        {KAZ_STALE_WORLD_MODULE, "with other Kaz headers"}}) {
    SCOPED_TRACE(path);
    const auto refused = load_world_by(path, "sim/worlds/empty.sdf");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::environment);
    for (const std::string& part : {path, reason, std::string("libsdformat-dev")})
      EXPECT_NE(refused.error().message.find(part), std::string::npos) << refused.error().message;
  }
  std::remove(text.c_str());
}

}  // namespace
}  // namespace kaz::tools
