// The module with the reader of worlds: the reader of this build, and modules that are not loaded.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/world_module.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace kaz::sim {
namespace {

// This test is linked with kaz::world_loader, as the program `kaz`.
TEST(WorldModule, IsLoadedWhenAWorldIsRead) {
  const auto is_loaded = [] {
    void* library = dlopen("libsdformat12.so.12", RTLD_NOW | RTLD_NOLOAD);
    if (library != nullptr) dlclose(library);
    return library != nullptr;
  };
  EXPECT_FALSE(is_loaded());
  const auto world = load_world("sim/worlds/boxes.sdf");
  ASSERT_TRUE(world) << world.error().message;
  EXPECT_GT(world->bodies.size(), 3u);
  EXPECT_TRUE(is_loaded());
}

TEST(WorldModule, PassesOptionsAndErrorsOn) {
  const auto missing = load_world("/none/world.sdf");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("/none/world.sdf"), std::string::npos)
      << missing.error().message;
  const std::string path = testing::TempDir() + "noted_" + std::to_string(getpid()) + ".sdf";
  std::ofstream(path) << "<sdf version='1.9'><world name='w'><gui/></world></sdf>\n";
  const auto noted = load_world(path);
  ASSERT_TRUE(noted) << noted.error().message;
  EXPECT_FALSE(noted->notes.empty());
  const auto strict = load_world(path, {.strict = true});
  ASSERT_FALSE(strict);
  EXPECT_EQ(strict.error().fault, Fault::usage);
  EXPECT_NE(strict.error().message.find("--strict"), std::string::npos) << strict.error().message;
  std::remove(path.c_str());
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
}  // namespace kaz::sim
