// The module with OMPL's planner: the planner of this build, and modules that are not loaded.
// SPDX-License-Identifier: Apache-2.0
#include "host/plan/ompl_module.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "host/plan/plan_testing.h"

namespace kaz::plan {
namespace {

// With OMPL or without: what the factory returns that is linked with this test.
TEST(OmplModule, HasThePlannerOfThisBuild) {
  const auto linked = make_ompl_planner(), loaded = load_ompl_planner();
  ASSERT_EQ(loaded.has_value(), linked.has_value()) << (loaded ? "loaded" : loaded.error().message);
  if (!linked) {
    EXPECT_EQ(loaded.error().message, linked.error().message);
    return;
  }
  EXPECT_EQ((*loaded)->name(), "ompl");
  const Task task = task_of(3);
  EXPECT_EQ(path_of(planned(**loaded, task.grid, task.start, task.goal)).corners,
            path_of(planned(**linked, task.grid, task.start, task.goal)).corners);
  EXPECT_EQ(load_ompl_planner({.batches = 0}).error().fault, Fault::usage);
}

TEST(OmplModule, IsRefusedWithItsPathAndTheReason) {
  const std::string text = testing::TempDir() + "text_" + std::to_string(getpid()) + ".so";
  std::ofstream(text) << "no module\n";
  for (const auto& [path, reason] :
       {std::pair<std::string, std::string>{"/none/ompl_planner.so", "No such file"},
        {text, "too short"},
        {KAZ_STALE_OMPL_MODULE, "with other Kaz headers"}}) {
    SCOPED_TRACE(path);
    const auto refused = load_ompl_planner({}, path);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::environment);
    for (const std::string& part : {path, reason, std::string("planner grid")})
      EXPECT_NE(refused.error().message.find(part), std::string::npos) << refused.error().message;
  }
  std::remove(text.c_str());
}

}  // namespace
}  // namespace kaz::plan
