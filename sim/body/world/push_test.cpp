// A world's <kaz:push> does what World::push() does at that time.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/body/description/files_testing.h"

namespace kaz::sim {
namespace {

class Pushes : public testing::TestWithParam<const char*> {
 protected:
  Result<std::unique_ptr<World>> load(const std::string& robot_element) {
    std::string text = test::world_text("0 0 -9.81", "");
    const std::string plain = "<kaz:robot pose=\"0 -3 0 0 0 0\"/>";
    text.replace(text.find(plain), plain.size(), robot_element);
    WorldOptions options;
    options.dynamics = GetParam();
    return World::load(folder_.write("w.sdf", text), test::kRobot, options);
  }
  test::Folder folder_;
};

INSTANTIATE_TEST_SUITE_P(Dynamics, Pushes, testing::Values("quick10", "reduced"));

TEST_P(Pushes, ActAtTheirTime) {
  const std::string start = "<kaz:robot pose='0 0 0 0 0 0'>";
  auto filed = load(start +
                    "<kaz:push time='0.05' link='trunk' impulse='0 0.3 0'/>"
                    "<kaz:push time='0.02' link='trunk' impulse='0.1 0 0'/></kaz:robot>");
  auto pushed = load(start + "</kaz:robot>");
  ASSERT_TRUE(filed) << filed.error().message;
  ASSERT_TRUE(pushed) << pushed.error().message;
  const test::Drives drives{};
  for (int step = 0; step < 100; ++step) {
    if (step == 20) {
      ASSERT_TRUE((*pushed)->push("trunk", {0.1, 0, 0}));
    }
    if (step == 50) {
      ASSERT_TRUE((*pushed)->push("trunk", {0, 0.3, 0}));
    }
    (*filed)->step(drives, 10);
    (*pushed)->step(drives, 10);
    ASSERT_EQ((*filed)->link_pose("trunk").matrix(), (*pushed)->link_pose("trunk").matrix())
        << "step " << step;
  }
}

// The robot faces the world's y axis: its left is -x.
TEST_P(Pushes, AreInTheAxesOfTheStart) {
  const auto world = load(
      "<kaz:robot pose='0 0 0 0 0 1.5707963267948966'>"
      "<kaz:push time='0' link='trunk' impulse='0 0.3 0'/></kaz:robot>");
  ASSERT_TRUE(world) << world.error().message;
  const Eigen::Vector3d start = (*world)->link_pose("trunk").translation();
  for (int step = 0; step < 50; ++step) (*world)->step(test::Drives{}, 10);
  const Eigen::Vector3d way = (*world)->link_pose("trunk").translation() - start;
  EXPECT_LT(way.x(), -0.003);
  EXPECT_LT(std::abs(way.y()), -0.2 * way.x());
}

// The robot is thrown up, and its soles rise: the push comes 20 steps after it has risen by 5 mm. A restored
// world goes on as the saved one.
TEST_P(Pushes, CountFromTheFirstStep) {
  const std::string start = "<kaz:robot pose='0 0 0 0 0 0'";
  const std::string counted =
      start + " first_step='l_ankle_pitch'><kaz:push time='0.02' link='trunk' impulse='0.1 0 0'/>" +
      "</kaz:robot>";
  auto filed = load(counted), other = load(counted), pushed = load(start + "/>");
  ASSERT_TRUE(filed && other && pushed);
  const auto height = [](const World& world) {
    return world.link_pose("l_ankle_pitch").translation().z();
  };
  const double low = height(**pushed);
  int first_step = -1;
  for (int step = 0; step < 250; ++step) {
    if (step == 100) {
      ASSERT_TRUE((*pushed)->push("trunk", {0, 0, 4}));
      ASSERT_TRUE((*filed)->push("trunk", {0, 0, 4}));
    }
    if (first_step < 0 && height(**pushed) > low + 0.005) first_step = step;
    if (first_step >= 0 && step == first_step + 10) {
      StateWriter saved;
      (*filed)->save(saved);
      StateReader from(saved.bytes());
      (*other)->restore(from);
      ASSERT_TRUE(from.error().empty()) << from.error();
      std::swap(*filed, *other);
    }
    if (first_step >= 0 && step == first_step + 20) {
      ASSERT_TRUE((*pushed)->push("trunk", {0.1, 0, 0}));
    }
    (*filed)->step(test::Drives{}, 10);
    (*pushed)->step(test::Drives{}, 10);
    ASSERT_EQ((*filed)->link_pose("trunk").matrix(), (*pushed)->link_pose("trunk").matrix())
        << "step " << step;
  }
  EXPECT_GT(first_step, 100);
  EXPECT_LT(first_step, 230);
}

TEST_P(Pushes, SinceTheStepOfAFootThatIsNotThereAreRefused) {
  const auto none = load("<kaz:robot pose='0 0 0 0 0 0' first_step='l_ankle_pitch tail'/>");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("<kaz:robot first_step> names the link `tail`"),
            std::string::npos)
      << none.error().message;
}

TEST_P(Pushes, OnWhatTheRobotDoesNotHaveAreRefused) {
  const auto none = load(
      "<kaz:robot pose='0 0 0 0 0 0'><kaz:push time='1' link='tail' impulse='0 1 0'/></kaz:robot>");
  ASSERT_FALSE(none);
  EXPECT_NE(
      none.error().message.find("<kaz:push> on the link `tail`, which the robot does not have"),
      std::string::npos)
      << none.error().message;
  const auto unnamed =
      load("<kaz:robot pose='0 0 0 0 0 0'><kaz:push time='1' impulse='0 1 0'/></kaz:robot>");
  ASSERT_FALSE(unnamed);
  EXPECT_NE(unnamed.error().message.find("needs the attribute `link`"), std::string::npos);
  const auto hard = load(
      "<kaz:robot pose='0 0 0 0 0 0'><kaz:push time='1' link='trunk' impulse='0 9 "
      "0'/></kaz:robot>");
  ASSERT_FALSE(hard);
  EXPECT_NE(hard.error().message.find("`impulse` with 3 numbers from -5 to 5 N s"),
            std::string::npos);
}

}  // namespace
}  // namespace kaz::sim
