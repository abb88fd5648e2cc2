// A build without OMPL: only where it is not installed, and its planner says so.
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <gtest/gtest.h>

#include "host/plan/ompl_planner.h"

namespace kaz::plan {
namespace {

TEST(OmplPlanner, IsAbsentOnlyWhereItIsNotInstalled) {
  for (const char* folder : {"/usr/include/ompl-1.5", "/usr/include/ompl"})
    EXPECT_FALSE(std::filesystem::exists(folder)) << "it is there, but CMake has not found it";
  const auto none = make_ompl_planner();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().fault, Fault::environment);
  EXPECT_NE(none.error().message.find("libompl-dev"), std::string::npos) << none.error().message;
}

}  // namespace
}  // namespace kaz::plan
