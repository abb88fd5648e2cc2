// A grasp holds: a rod pinched between two fingers does not creep under its weight.
// SPDX-License-Identifier: Apache-2.0
//
// The cases follow a report on MuJoCo (google-deepmind/mujoco issue 3328), whose regularized friction lets a
// capsule of 45 g creep by 50 to 2300 um/s.
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "sim/body/reduced/reduced_world.h"
#include "sim/body/world/plain_models_testing.h"

namespace kaz::sim {
namespace {

using Eigen::Vector3d;

constexpr double kRodRadius = 0.004, kPinchedMass = 0.045, kFingerPinion = 0.01, kVolts = 10;

MotorParams light_motor() {
  MotorParams motor = test::free_motor();
  motor.rotor_inertia_kgm2 = 1e-6;
  return motor;
}

// Two fingers that slide along x and touch the rod.
RobotModel gripper(const Surface& surface) {
  constexpr double kThickness = 0.01, kOverlap = 1e-5;  // m
  RobotModel robot = test::fixed_place();
  for (const double side : {-1.0, 1.0}) {
    const std::string name = side < 0 ? "left" : "right";
    test::add_link(robot, test::box(name, 0.1, {kThickness, 0.06, 0.04}, surface),
                   {side * (kRodRadius - kOverlap + kThickness / 2), 0, 0.5},
                   -side * Vector3d::UnitX(), -0.1, 0.1);
    robot.links.back().parent = 0;
    robot.joints.back().pinion_m = kFingerPinion;
  }
  return robot;
}

RigidLink pinched_rod(const Surface& surface) {
  constexpr double kLength = 0.03;
  RigidLink rod;
  rod.name = "rod";
  rod.mass = kPinchedMass;
  const double about = kPinchedMass * kRodRadius * kRodRadius / 2;
  const double across = about / 2 + kPinchedMass * kLength * kLength / 12;
  rod.inertia = Vector3d(across, across, about).asDiagonal();
  rod.collisions.push_back(test::touching(Shape::Kind::capsule, {kRodRadius, kLength, 0}, surface));
  return rod;
}

// Grip force as a multiple of the smallest one that holds, angle between rod and vertical (rad), compliance
// of the contact (m/s per N), step (s).
using Grip = std::tuple<double, double, double, double>;

class Pinch : public testing::TestWithParam<Grip> {};

TEST_P(Pinch, DoesNotCreep) {
  const auto& [margin, angle, softness, step_s] = GetParam();
  const Surface surface{.mu = 0.7, .softness = softness / 2};
  WorldModel around;
  WorldBody rod = test::thing(pinched_rod(surface), {0, 0, 0.5});
  rod.pose.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix();
  around.bodies.push_back(rod);
  WorldOptions options;
  options.step_s = step_s;
  ReducedWorld world(around, gripper(surface), light_motor(), options);
  const double grip = margin * kPinchedMass * 9.81 / (2 * surface.mu);
  const double duty = grip * kFingerPinion / light_motor().stall_slope_nm_per_v / kVolts;
  const std::vector<MotorDrive> drives(2, {duty, true});
  const auto run_until = [&](double seconds) {
    while (world.time_s() < seconds - step_s / 2) world.step(drives, kVolts);
    return world.object_position("rod").value().z();
  };
  const double start = run_until(2), end = run_until(10);
  EXPECT_LT(std::abs(end - start) / 8, 1e-6);  // m/s
  EXPECT_NEAR(end, 0.5, 1e-3);
  EXPECT_NEAR(world.link_forces()[1].pressure, grip, 0.02 * grip);
}

INSTANTIATE_TEST_SUITE_P(Grips, Pinch,
                         testing::Values(Grip{20, M_PI / 2, 0, 1e-3}, Grip{95, M_PI / 2, 0, 1e-3},
                                         Grip{20, M_PI / 2, 1e-3, 1e-3},
                                         Grip{95, M_PI / 2, 1e-3, 1e-3},
                                         Grip{20, M_PI / 2, 0, 4e-3}, Grip{20, 1, 0, 1e-3},
                                         Grip{95, 0, 0, 1e-3}));

}  // namespace
}  // namespace kaz::sim
