// Objects against school mechanics: fall, bounce, rolling, friction, flicks.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include <ode/ode.h>

#include "sim/body/description/files_testing.h"

namespace kaz::sim {
namespace {

using test::Drives;
using test::run;

constexpr double kG = 9.81, kRadius = 0.02;

std::string ball(const std::string& z, const std::string& surface, const std::string& extra = "") {
  return R"(<model name="ball"><pose>0 0 )" + z + R"( 0 0 0</pose><link name="l">
<inertial><mass>0.015</mass><inertia><ixx>2.4e-6</ixx><iyy>2.4e-6</iyy><izz>2.4e-6</izz>
</inertia></inertial><collision name="c"><geometry><sphere><radius>0.02</radius></sphere></geometry>
<surface>)" +
         surface + "</surface></collision></link>" + extra + "</model>";
}

class Objects : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<World> load(const std::string& gravity, const std::string& models) {
    WorldOptions options;
    options.dynamics = GetParam();
    // The robot is no part of this: a small one, on its own base.
    auto world = World::load(folder_.write("w.sdf", test::world_text(gravity, models)),
                             "sim/robots/arm/arm.urdf", options);
    EXPECT_TRUE(world) << world.error().message;
    return world ? std::move(*world) : nullptr;
  }
  static Eigen::Vector3d at(const World& world, const char* model) {
    return world.object_position(model).value();
  }
  test::Folder folder_;
};

INSTANTIATE_TEST_SUITE_P(Dynamics, Objects, testing::Values("quick10", "exact", "reduced"));

TEST_P(Objects, FallAndBounce) {
  const double height = 0.5, restitution = 0.7;
  const auto world = load("0 0 -9.81", ball("0.52",
                                            "<bounce><restitution_coefficient>0.7"
                                            "</restitution_coefficient><threshold>0.05"
                                            "</threshold></bounce>"));
  ASSERT_TRUE(world);
  const Drives drives{};
  double last = 1, landed = 0, top = 0;
  while (world->time_s() < 0.75) {
    world->step(drives, 10);
    const double z = at(*world, "ball").z();
    if (landed == 0 && z > last) landed = world->time_s();
    if (landed > 0) top = std::max(top, z);
    last = z;
  }
  std::printf("%s: lands off by %+.2f ms, top off by %+.2f mm\n", GetParam(),
              1e3 * (landed - std::sqrt(2 * height / kG)),
              1e3 * (top - kRadius - restitution * restitution * height));
  // Seen to rise a step after the one in which it met the floor.
  EXPECT_NEAR(landed, std::sqrt(2 * height / kG), 0.002);
  // It meets the floor at 3.13 m/s at any point of a step, up to 3.1 mm deep, and rises from there; its
  // speed is that of the end of a step, up to g h = 10 mm/s off, which is 1.5 mm of its height.
  EXPECT_NEAR(top - kRadius, restitution * restitution * height, 0.005);
}

TEST_P(Objects, FlickedBallEndsRollingAtFiveSevenths) {
  // Friction spins a uniform sphere up until it rolls; angular momentum about the contact stays.
  const auto world = load("0 0 -9.81", ball("0.02", "<friction><ode><mu>1</mu></ode></friction>",
                                            R"(<kaz:kick time="0.1" velocity="0.28 0.21 0"/>)"));
  ASSERT_TRUE(world);
  run(*world, 0.5);
  const Eigen::Vector3d before = at(*world, "ball");
  run(*world, 0.5);
  const Eigen::Vector3d v = (at(*world, "ball") - before) / 0.5;
  EXPECT_NEAR(v.x(), 5.0 / 7 * 0.28, 0.003);
  EXPECT_NEAR(v.y(), 5.0 / 7 * 0.21, 0.003);
}

TEST_P(Objects, RollingResistanceStopsTheBall) {
  // Moment rho N against a rolling sphere: a = rho g / (7/5 r).
  const double rho = 0.0005, a = rho * kG / (1.4 * kRadius);
  const auto world = load("0 0 -9.81", ball("0.02", R"(<kaz:rolling_resistance metres="0.0005"/>)",
                                            R"(<kaz:kick time="0.1" velocity="0.28 0.21 0"/>)"));
  ASSERT_TRUE(world);
  run(*world, 0.3);
  const Eigen::Vector3d p0 = at(*world, "ball");
  run(*world, 0.2);
  const Eigen::Vector3d p1 = at(*world, "ball");
  run(*world, 0.5);
  const Eigen::Vector3d p2 = at(*world, "ball");
  run(*world, 0.2);
  const Eigen::Vector3d p3 = at(*world, "ball");
  const double v0 = (p1 - p0).norm() / 0.2, v1 = (p3 - p2).norm() / 0.2;
  EXPECT_NEAR((v0 - v1) / 0.7, a, 0.05 * a);
  // It keeps its direction: 0.21 / 0.28.
  EXPECT_NEAR((p3 - p0).y() / (p3 - p0).x(), 0.75, 0.02);
  run(*world, 0.8);
  const Eigen::Vector3d rest = at(*world, "ball");
  run(*world, 0.2);
  EXPECT_EQ(at(*world, "ball"), rest);
}

std::string block() {
  return R"(<model name="block"><pose>0 0 0.01 0 0 0</pose><link name="l">
<inertial><mass>0.1</mass>
<inertia><ixx>3e-5</ixx><iyy>3e-5</iyy><izz>5e-5</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.06 0.06 0.02</size></box></geometry></collision>
</link></model>)";
}

// A slope is a floor with gravity turned; mu is 0.5, so the angle of repose is 26.6 degrees.
std::string slope(double degrees) {
  const double a = degrees * 3.14159265358979323846 / 180;
  return std::to_string(kG * std::sin(a)) + " 0 " + std::to_string(-kG * std::cos(a));
}

TEST_P(Objects, BlockStaysBelowTheAngleOfRepose) {
  const auto world = load(slope(25), block());
  ASSERT_TRUE(world);
  run(*world, 1.0);
  EXPECT_NEAR(at(*world, "block").x(), 0, 0.001);
}

TEST_P(Objects, BlockSlidesAboveTheAngleOfRepose) {
  const auto world = load(slope(30), block());
  ASSERT_TRUE(world);
  run(*world, 1.0);
  const double a = 30 * 3.14159265358979323846 / 180;
  const double acceleration = kG * (std::sin(a) - 0.5 * std::cos(a));
  EXPECT_NEAR(at(*world, "block").x(), 0.5 * acceleration, 0.03 * acceleration);
}

// mu 0.5: tan 26.57 degrees. Half a degree beside it the block lies, and slides as the rest of its
// weight says: 1 % of it there, so that 5 % of the path are half a thousandth of the friction. The
// millimetre is what it takes to sit down.
TEST_P(Objects, BlockSlipsAtTheAngleOfItsFriction) {
  const auto below = load(slope(26.07), block());
  ASSERT_TRUE(below);
  run(*below, 2.0);
  EXPECT_NEAR(at(*below, "block").x(), 0, 0.001);
  const auto above = load(slope(27.07), block());
  ASSERT_TRUE(above);
  run(*above, 2.0);
  const double a = 27.07 * 3.14159265358979323846 / 180;
  const double path = 2 * kG * (std::sin(a) - 0.5 * std::cos(a));
  EXPECT_NEAR(at(*above, "block").x(), path, 0.05 * path);
}

TEST_P(Objects, StackStays) {
  std::string boxes;
  for (int i = 0; i < 5; ++i) {
    const std::string name = "box" + std::to_string(i);
    boxes += "<model name=\"" + name + "\"><pose>0 0 " + std::to_string(0.02 + 0.04 * i) +
             R"( 0 0 0</pose><link name="l"><inertial><mass>0.04</mass>
<inertia><ixx>1.07e-5</ixx><iyy>1.07e-5</iyy><izz>1.07e-5</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.04 0.04 0.04</size></box></geometry>
<surface><contact><ode><soft_cfm>0.005</soft_cfm></ode></contact></surface></collision></link>
</model>)";
  }
  const auto world = load("0 0 -9.81", boxes);
  ASSERT_TRUE(world);
  // The solver gives up, and leaves out all forces, where it cannot tell the corners apart.
  static int complaints;
  complaints = 0;
  dSetMessageHandler([](int, const char*, va_list) { ++complaints; });
  run(*world, 5.0);
  dSetMessageHandler(nullptr);
  EXPECT_EQ(complaints, 0);
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d p = at(*world, ("box" + std::to_string(i)).c_str());
    EXPECT_LT(p.head<2>().norm(), 0.001) << i;
    // Five soft seams give by some 0.1 mm each.
    EXPECT_NEAR(p.z(), 0.02 + 0.04 * i, 0.002) << i;
  }
}

TEST_P(Objects, KickComesAtItsTimeAndAddsItsVelocity) {
  const auto world = load("0 0 0", ball("1", "", R"(<kaz:kick time="0.2" velocity="0.3 0 0"/>
<kaz:kick time="0.1" velocity="0 0.5 0"/>)"));
  ASSERT_TRUE(world);
  run(*world, 0.1);
  EXPECT_EQ(at(*world, "ball"), Eigen::Vector3d(0, 0, 1));
  run(*world, 0.1);
  EXPECT_NEAR(at(*world, "ball").y(), 0.05, 1e-9);
  EXPECT_EQ(at(*world, "ball").x(), 0);
  run(*world, 0.1);
  EXPECT_NEAR(at(*world, "ball").x(), 0.03, 1e-9);
  EXPECT_NEAR(at(*world, "ball").y(), 0.10, 1e-9);
}

}  // namespace
}  // namespace kaz::sim
