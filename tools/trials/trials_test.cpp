// Statistics against published values, and robot folders.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tools/trials/robot_folder.h"
#include "tools/trials/statistics.h"

namespace kaz::trials {
namespace {

TEST(Statistics, WilsonIntervals) {
  EXPECT_NEAR(wilson(196, 200).min, 0.9497, 2e-4);
  EXPECT_NEAR(wilson(196, 200).max, 0.9922, 2e-4);
  EXPECT_NEAR(wilson(2, 2).min, 0.3424, 1e-4);
  EXPECT_NEAR(wilson(2, 2).max, 1, 1e-12);
  EXPECT_EQ(wilson(0, 0).min, 0);
  EXPECT_EQ(wilson(0, 0).max, 1);
}

TEST(Statistics, QuantileReturnsAValue) {
  EXPECT_EQ(quantile({}, 0.5), 0);
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile({3, 1, 2}, 0.95), 3);
  EXPECT_EQ(quantile({3, 1, 2}, 0), 1);
}

TEST(Statistics, SummaryOfASample) {
  EXPECT_EQ(summarize({}).sigma, 0);
  EXPECT_EQ(summarize({7}).sigma, 0);
  const Summary s = summarize({2, 4, 4, 4, 5, 5, 7, 9});
  EXPECT_DOUBLE_EQ(s.mean, 5);
  EXPECT_DOUBLE_EQ(s.sigma, std::sqrt(32.0 / 7));
  EXPECT_EQ(s.max, 9);
}

TEST(Statistics, ErrorsBySizeAndWithSign) {
  Errors errors;
  EXPECT_EQ(errors.rms() + errors.max() + errors.percentile(0.5) + errors.sigma(), 0);
  for (const double v : {-4.0, 1.0, 2.0, 3.0, -2.0}) errors.add(v);
  EXPECT_EQ(errors.count(), 5u);
  EXPECT_DOUBLE_EQ(errors.mean(), 0);
  EXPECT_DOUBLE_EQ(errors.rms(), std::sqrt(34.0 / 5));
  EXPECT_DOUBLE_EQ(errors.sigma(), errors.rms());
  EXPECT_EQ(errors.max(), 4);
  EXPECT_EQ(errors.percentile(0.5), 2);
  EXPECT_EQ(errors.percentile(1), 4);
}

TEST(RobotFolder, ScalesEachMassByItsOwnFactor) {
  const std::string urdf =
      "<inertial><mass value=\"2\"/><inertia ixx=\"1\" iyy=\"4\" izz=\"3\" ixy=\"0\" ixz=\"0\" "
      "iyz=\"0\"/></inertial><limit lower=\"1\"/><inertial><mass value=\"5\"/></inertial>";
  const std::string changed =
      with_masses(urdf, [](std::uint64_t number) { return number == 0 ? 2.0 : 0.5; });
  EXPECT_NE(changed.find("<mass value=\"4\"/><inertia ixx=\"2\" iyy=\"8\" izz=\"6\""),
            std::string::npos);
  EXPECT_NE(changed.find("<limit lower=\"1\"/><inertial><mass value=\"2.5\"/>"), std::string::npos);
}

TEST(RobotFolder, IsRemovedWithTheObjectAndNamesAMissingFile) {
  std::string path;
  {
    const auto made = RobotFolder::make("shared/robot/kaz", {}, "<sdf/>");
    ASSERT_TRUE(made) << made.error().message;
    path = made->robot();
    EXPECT_TRUE(std::filesystem::exists(path));
    EXPECT_TRUE(std::filesystem::exists(made->world()));
    std::map<std::string, std::string> kept;
    EXPECT_TRUE(made->each([&kept](const std::string& name, const std::string& contents) {
      kept[name] = contents;
      return Result<void>();
    }));
    EXPECT_EQ(kept.size(), 5u);
    EXPECT_EQ(kept["world.sdf"], "<sdf/>");
    EXPECT_TRUE(kept.contains("sensors.xml"));
    const auto full = made->each([](const std::string&, const std::string&) -> Result<void> {
      return fail(Fault::environment, "disk full");
    });
    EXPECT_FALSE(full);
    std::filesystem::remove(made->camera());
    const auto gone = made->each([](const auto&, const auto&) { return Result<void>(); });
    ASSERT_FALSE(gone);
    EXPECT_NE(gone.error().message.find("camera.json"), std::string::npos);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  const auto none = RobotFolder::make("nowhere", {}, "");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("nowhere/kaz.urdf"), std::string::npos);
}

}  // namespace
}  // namespace kaz::trials
