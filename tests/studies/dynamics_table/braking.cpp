// A shoe on a lever that brakes a plank: friction changes the normal force that bounds it.
// SPDX-License-Identifier: Apache-2.0

#include "tests/studies/dynamics_table/scene.h"

namespace kaz::dynamics_table {
namespace {

using Eigen::Vector3d;

constexpr double kMu = 0.5, kLeverMass = 0.1, kPlankMass = 0.5;
constexpr double kAhead = 0.15, kBelow = 0.12, kTip = 0.005;  // m, of the contact from the hinge

// A lever hinged above the plank, its weight in the middle, with a small ball as shoe. Frame: x from the
// hinge to the shoe, z up.
sim::RobotModel lever() {
  sim::RigidLink rigid;
  rigid.name = "lever";
  rigid.mass = kLeverMass;
  rigid.com = Vector3d(kAhead / 2, 0, -kBelow / 2);
  rigid.inertia = Vector3d(1e-4, 2e-4, 1e-4).asDiagonal();
  sim::CollisionShape shoe =
      sim::test::touching(sim::Shape::Kind::sphere, {kTip, 0, 0}, {.mu = kMu});
  shoe.in_link.translation() = Vector3d(kAhead, 0, kTip - kBelow);
  rigid.collisions.push_back(shoe);
  sim::RobotModel robot = sim::test::fixed_place();
  sim::test::add_link(robot, rigid, Vector3d::Zero(), Vector3d::UnitY(), -1e3, 1e3);
  return robot;
}

// Moments about the hinge, of weight, normal force N and friction mu N along the plank's velocity:
//   m g ahead / 2 = N (ahead + mu below)   the plank moves away from the hinge: a trailing shoe
//   m g ahead / 2 = N (ahead - mu below)   towards it: a leading, self-energising shoe
// (J. Shigley & C. Mischke, "Mechanical Engineering Design", brakes with short shoes).
void brake(const std::string& stepper, Table& table, double way, const std::string& what) {
  constexpr double thickness = 0.02, speed = 0.5;
  sim::WorldModel around = sim::test::floor_of({.mu = 0}, {0, 0, -kG});
  around.bodies.push_back(
      sim::test::thing(sim::test::box("plank", kPlankMass, {1, 0.2, thickness}, {.mu = 1}),
                       {kAhead, 0, thickness / 2}));
  around.bodies.back().kicks.push_back({0.2, {way * speed, 0, 0}});
  around.robot_start.translation().z() = thickness + kBelow;
  const auto world = world_of(stepper, around, lever(), sim::test::free_motor());
  const std::array<sim::MotorDrive, 1> open{};
  run(*world, 0.22, open);
  // Second differences cancel the initial settling.
  std::array<double, 3> at{};
  for (double& x : at) {
    run(*world, 0.05, open);
    x = world->object_position("plank").value().x();
  }
  const double normal = kLeverMass * kG * kAhead / 2 / (kAhead + way * kMu * kBelow);
  const double slower = kMu * normal / kPlankMass;
  table.put(stepper, "shoe on a lever brakes a plank, mu 0.5", "deceleration, " + what,
            value("mu N / M = %.4f m/s²", slower), "",
            -way * (at[2] - 2 * at[1] + at[0]) / 0.0025 / slower - 1);
}

}  // namespace

void brake(const std::string& stepper, Table& table) {
  brake(stepper, table, 1, "trailing");
  brake(stepper, table, -1, "leading");
}

}  // namespace kaz::dynamics_table
