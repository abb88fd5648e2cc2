// Tosses on the dynamics engines of Kaz.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sim/body/world/plain_models_testing.h"
#include "sim/body/world/staged_world.h"
#include "tests/studies/contact/engine.h"

namespace kaz::contact {
namespace {

const char* const kCube = "cube";

struct ContactValues {
  double mu, restitution, softness, floor;
};

// A cube at the first pose of a toss above a floor at the height `floor` (m).
sim::WorldModel cube_world(const ContactValues& values, const Pose& start) {
  const sim::Surface hard{.mu = values.mu},
      cube{.mu = values.mu, .softness = values.softness, .restitution = values.restitution};
  sim::WorldModel world = sim::test::floor_of(hard, {0, 0, -kGravity});
  world.bodies[0].pose.translation().z() = values.floor;
  sim::RigidLink link =
      sim::test::box(kCube, kCubeMass, Eigen::Vector3d::Constant(2 * kHalf), cube);
  link.inertia = kCubeInertia * Eigen::Matrix3d::Identity();
  world.bodies.push_back(sim::test::thing(link, start.at));
  world.bodies.back().pose.linear() = start.turn.toRotationMatrix();
  return world;
}

Pose pose_of(const sim::World& world) {
  const Eigen::Isometry3d pose = world.pose().frames.back();
  return {pose.translation(), Eigen::Quaterniond(pose.linear())};
}

Result<Path> simulate_in_kaz(const Toss& toss, const ContactValues& values,
                             const sim::WorldOptions& options, int steps) {
  const auto world =
      KAZ_TRY(sim::make_world(cube_world(values, toss.path.front()), sim::test::fixed_place(),
                              sim::test::free_motor(), options));
  KAZ_TRY(world->accelerate(kCube, toss.velocity.front(), toss.spin.front()));
  Path path{toss.path.front()};
  while (path.size() < toss.path.size()) {
    for (int i = 0; i < steps; ++i) world->step({}, 0);
    path.push_back(pose_of(*world));
  }
  return path;
}

}  // namespace

Result<Engine> kaz_engine(const std::string& dynamics, int steps) {
  sim::WorldOptions options;
  options.dynamics = dynamics;
  options.step_s = 1 / (kRate * steps);
  // Checks name and step.
  KAZ_TRY(sim::make_world(cube_world({0.2, 0, 0, 0}, {}), sim::test::fixed_place(),
                          sim::test::free_motor(), options));
  Engine engine;
  engine.name = dynamics;
  engine.parameters = {{"mu", "", 0.02, 1, 0.18, true},
                       {"restitution", "", 0, 0.9, 0.12, false},
                       {"softness", "m/s per N", 1e-5, 1, 1e-2, true},
                       {"floor", "m", -0.005, 0.002, -0.001, false}};
  engine.simulate = [options, steps](const Toss& toss, std::span<const double> v) {
    return simulate_in_kaz(toss, {v[0], v[1], v[2], v[3]}, options, steps);
  };
  return engine;
}

}  // namespace kaz::contact
