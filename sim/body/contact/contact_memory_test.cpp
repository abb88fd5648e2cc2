// Soft surfaces in shear: a spring that slips, known again from step to step; soles that stay.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/contact/contact_memory.h"

#include <cmath>

#include "sim/body/contact/contact_surface.h"
#include "sim/body/description/files_testing.h"
#include "sim/body/world/gait_testing.h"

namespace kaz::sim {
namespace {

constexpr double kStep = 0.001, kSoftness = 5e-3, kMu = 0.7;
constexpr double kStiffness = kContactErp / (kStep * kSoftness);  // N/m

Touch corner(double x, double y) {
  Touch touch;
  touch.body_a = 0;
  touch.at = {x, y, 0};
  touch.normal = Eigen::Vector3d::UnitZ();
  touch.surface.mu = kMu;
  touch.surface.softness = kSoftness;
  return touch;
}

TEST(ContactMemory, AddsUpWhatMovesAcrossTheNormal) {
  ContactMemory memory;
  const std::vector<Touch> touches{corner(0, 0), corner(0.05, 0)};
  for (int i = 0; i < 10; ++i) {
    memory.recall(touches);
    memory.remember(0, {1e-3, -2e-3, 5e-3}, 4.0, kStep);
    memory.remember(1, Eigen::Vector3d::Zero(), 4.0, kStep);
  }
  EXPECT_TRUE(memory.shear(0).isApprox(Eigen::Vector3d(1e-5, -2e-5, 0), 1e-9));
  EXPECT_EQ(memory.shear(1), Eigen::Vector3d::Zero());
}

TEST(ContactMemory, SlipsWhereItsSpringPullsAsHardAsFriction) {
  ContactMemory memory;
  const std::vector<Touch> touches{corner(0, 0)};
  for (int i = 0; i < 1000; ++i) {
    memory.recall(touches);
    memory.remember(0, {0.3, 0.4, 0}, 4.0, kStep);
  }
  EXPECT_NEAR(kStiffness * memory.shear(0).norm(), kMu * 4.0, 1e-9);
  EXPECT_NEAR(memory.shear(0).y() / memory.shear(0).x(), 4.0 / 3, 1e-9);
  // Lifted, it lets go at once; a pull along the normal holds nothing either.
  memory.remember(0, Eigen::Vector3d::Zero(), -1.0, kStep);
  EXPECT_EQ(memory.shear(0), Eigen::Vector3d::Zero());
}

TEST(ContactMemory, KnowsAPointAgainByItsShapesAndPlace) {
  ContactMemory memory;
  memory.recall(std::vector<Touch>{corner(0, 0), corner(0.05, 0)});
  memory.remember(0, {0.01, 0, 0}, 4.0, kStep);
  memory.remember(1, {0.02, 0, 0}, 4.0, kStep);
  // ODE names the corners in another order, and one has moved on by a millimetre.
  memory.recall(std::vector<Touch>{corner(0.051, 0), corner(0, 0)});
  EXPECT_NEAR(memory.shear(0).x(), 2e-5, 1e-12);
  EXPECT_NEAR(memory.shear(1).x(), 1e-5, 1e-12);
  Touch other = corner(0, 0);
  other.shape_b = 7;
  memory.recall(std::vector<Touch>{other, corner(0.055, 0)});
  EXPECT_EQ(memory.shear(0), Eigen::Vector3d::Zero());
  EXPECT_EQ(memory.shear(1), Eigen::Vector3d::Zero());
  memory.recall(std::vector<Touch>{});
  memory.recall(std::vector<Touch>{corner(0.055, 0)});
  EXPECT_EQ(memory.shear(0), Eigen::Vector3d::Zero()) << "it was lifted in between";
}

// The friction that is left after so few iterations turned the robot by 0.02 degrees a second, and
// pushed it by 0.03 mm.
TEST(ContactMemory, SolesStayWhereTheyAre) {
  const auto world = test::load_or_fail(test::kEmpty, {.dynamics = "quick20"});
  ASSERT_TRUE(world);
  const auto hold = [&](double until) {
    const bench::Angles crouch = bench::walking_angles(0, 0);
    while (world->time_s() < until) {
      test::Drives drives;
      const double into = std::min(1.0, world->time_s());
      for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
        const JointState& joint = world->joints()[i];
        drives[i] = {20 * (into * crouch[i] - joint.angle) - 0.15 * joint.velocity, true};
      }
      world->step(drives, 10);
    }
  };
  hold(2.0);
  const Eigen::Isometry3d left = world->link_pose("l_ankle_pitch"),
                          right = world->link_pose("r_ankle_pitch");
  hold(8.0);
  for (const auto& [name, before] : {std::pair{"l_ankle_pitch", left}, {"r_ankle_pitch", right}}) {
    const Eigen::Isometry3d moved = before.inverse() * world->link_pose(name);
    // Their springs hold the weight's share of it within some micrometres.
    EXPECT_LT(moved.translation().norm(), 2e-5) << name;
    EXPECT_LT(Eigen::AngleAxisd(moved.linear()).angle(), 0.02 * M_PI / 180) << name;
  }
}

// The fixed base of the arm is the first of the pair, and does not move.
TEST(ContactMemory, HoldsABlockOnWhatIsFixed) {
  for (const char* dynamics : {"quick50", "exact", "reduced"}) {
    test::Folder folder;
    const std::string world_path =
        folder.write("w.sdf", R"(<?xml version="1.0"?><sdf version="1.9"><world name="test">
<gravity>0 1.7 -9.66</gravity><model name="block"><pose>0.043 0 0.026 0 0 0</pose><link name="l">
<inertial><mass>0.1</mass><inertia><ixx>3e-6</ixx><iyy>3e-6</iyy><izz>3e-6</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.012 0.012 0.012</size></box></geometry></collision>
</link></model></world></sdf>)");
    const auto loaded = World::load(world_path, "sim/robots/arm/arm.urdf", {.dynamics = dynamics});
    ASSERT_TRUE(loaded) << loaded.error().message;
    World& world = **loaded;
    const std::vector<MotorDrive> off(6);
    // It sinks into the layer that is left as it is for 0.2 s, and leans meanwhile.
    for (int i = 0; i < 300; ++i) world.step(off, 10.0);
    // Four springs along the plate, and as many below the edges, on which it leans: its height over
    // their distance is one half on either side.
    const Eigen::Vector3d at = world.object_position("block").value();
    EXPECT_NEAR(at.y(), 2 * 0.1 * 1.7 / (4 * kStiffness), 2e-7) << dynamics;
    EXPECT_NEAR(at.x(), 0.043, 2e-7) << dynamics;
  }
}

}  // namespace
}  // namespace kaz::sim
