// Intervals against published values, files against what was asked, work against its errors.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <set>

#include "tools/trials/robot_folder.h"
#include "tools/trials/run_jobs.h"
#include "tools/trials/statistics.h"

namespace kaz::trials {
namespace {

TEST(Statistics, IntervalsAreWilsons) {
  EXPECT_NEAR(wilson(196, 200).least, 0.9497, 2e-4);
  EXPECT_NEAR(wilson(196, 200).most, 0.9922, 2e-4);
  EXPECT_NEAR(wilson(2, 2).least, 0.3424, 1e-4);
  EXPECT_NEAR(wilson(2, 2).most, 1, 1e-12);
  EXPECT_EQ(wilson(0, 0).least, 0);
  EXPECT_EQ(wilson(0, 0).most, 1);
}

TEST(Statistics, QuantilesAreValues) {
  EXPECT_EQ(quantile({}, 0.5), 0);
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile({3, 1, 2}, 0.95), 3);
  EXPECT_EQ(quantile({3, 1, 2}, 0), 1);
}

TEST(RobotFolder, ChangesEachMassByItsOwnFactor) {
  const std::string urdf =
      "<inertial><mass value=\"2\"/><inertia ixx=\"1\" iyy=\"4\" izz=\"3\" ixy=\"0\" ixz=\"0\" "
      "iyz=\"0\"/></inertial><limit lower=\"1\"/><inertial><mass value=\"5\"/></inertial>";
  const std::string changed =
      with_masses(urdf, [](std::uint64_t number) { return number == 0 ? 2.0 : 0.5; });
  EXPECT_NE(changed.find("<mass value=\"4\"/><inertia ixx=\"2\" iyy=\"8\" izz=\"6\""),
            std::string::npos);
  EXPECT_NE(changed.find("<limit lower=\"1\"/><inertial><mass value=\"2.5\"/>"), std::string::npos);
}

TEST(RobotFolder, GoesWithItsObjectAndNamesWhatIsMissing) {
  std::string path;
  {
    const auto made = RobotFolder::make("shared/robot/kaz", {}, "<sdf/>");
    ASSERT_TRUE(made) << made.error().message;
    path = made->robot();
    EXPECT_TRUE(std::filesystem::exists(path));
    EXPECT_TRUE(std::filesystem::exists(made->world()));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  const auto none = RobotFolder::make("nowhere", {}, "");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("nowhere/kaz.urdf"), std::string::npos);
}

TEST(RunJobs, RunsEachOnceAndEndsWithTheFirstError) {
  std::set<std::size_t> done;
  EXPECT_TRUE(run_jobs(50, 3, [&](std::size_t i) {
    return [&done, i]() -> Result<void> {
      EXPECT_TRUE(done.insert(i).second);
      return {};
    };
  }));
  EXPECT_EQ(done.size(), 50U);
  std::atomic<int> begun = 0;
  const auto failed = run_jobs(1000, 2, [&](std::size_t i) {
    ++begun;
    return [i]() -> Result<void> {
      if (i == 3) return fail(Fault::usage, "the fourth");
      return {};
    };
  });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "the fourth");
  EXPECT_LT(begun, 1000);
}

}  // namespace
}  // namespace kaz::trials
