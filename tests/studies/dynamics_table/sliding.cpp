// Dry friction: a block that slides to a stop, holds on a slope, slides down it.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/studies/dynamics_table/scene.h"

namespace kaz::dynamics_table {
namespace {

constexpr double kMu = 0.5, kMass = 0.1;
constexpr double kSole = 0.005;                 // m/s per N
const Eigen::Vector3d kSize(0.06, 0.06, 0.02);  // flat: friction does not tip it

// The block is a robot of one link, which is never put to sleep: sleeping would hide creep.
std::unique_ptr<sim::StagedWorld> block_on(const std::string& stepper, double slope,
                                           double softness) {
  const sim::Surface surface{.mu = kMu, .softness = softness};
  return world_of(stepper, sim::test::floor_of({.mu = 1}, on_slope(slope)),
                  sim::test::lone(sim::test::box("block", kMass, kSize, surface)),
                  sim::test::free_motor());
}

double along(const sim::World& world) {
  return world.link_pose("block").translation().x();
}

void slide_to_a_stop(const std::string& stepper, Table& table, double softness,
                     const std::string& what) {
  constexpr double speed = 1.0;
  const auto world = block_on(stepper, 0, softness);
  run(*world, 0.3);
  const double from = along(*world), began = world->time_s();
  static_cast<void>(world->push("block", {kMass * speed, 0, 0}));
  double before = from, stopped = 0;
  while (world->time_s() < began + 1) {
    world->step({}, kVolts);
    // Slower than the change of velocity by friction in a step: the block stops within the next one.
    if (stopped == 0 && along(*world) - before < kMu * kG * kStep * kStep)
      stopped = world->time_s() - began;
    before = along(*world);
  }
  const double distance = speed * speed / (2 * kMu * kG), time = speed / (kMu * kG);
  const std::string scene = std::string("block pushed to 1 m/s, mu 0.5, ").append(what);
  table.put(stepper, scene, "distance to its stop", value("v²/(2 mu g) = %.4f m", distance), "",
            (along(*world) - from) / distance - 1);
  table.put(stepper, scene, "time to its stop", value("v/(mu g) = %.4f s", time), "",
            stopped / time - 1);
}

void hold(const std::string& stepper, Table& table, double softness, const std::string& what) {
  const auto world = block_on(stepper, 25 * M_PI / 180, softness);
  run(*world, 5);
  const double from = along(*world);
  run(*world, 10);
  table.put(stepper, "block on a slope of 25°, mu 0.5 (26.6°)", "creep in 10 s, " + what, "none",
            "m", along(*world) - from);
}

void slide_down(const std::string& stepper, Table& table, double degrees) {
  const double slope = degrees * M_PI / 180;
  const auto world = block_on(stepper, slope, 0);
  // Second differences cancel the initial settling.
  std::array<double, 3> at{};
  for (double& x : at) {
    run(*world, 0.5);
    x = along(*world);
  }
  const double acceleration = kG * (std::sin(slope) - kMu * std::cos(slope));
  table.put(stepper, value("block on a slope of %g°", degrees), "acceleration",
            value("g (sin a - mu cos a) = %.4f m/s²", acceleration), "",
            (at[2] - 2 * at[1] + at[0]) / 0.25 / acceleration - 1);
}

}  // namespace

void slide(const std::string& stepper, Table& table) {
  slide_to_a_stop(stepper, table, 0, "hard");
  slide_to_a_stop(stepper, table, kSole, "soft as a sole");
  hold(stepper, table, 0, "hard");
  hold(stepper, table, kSole, "soft as a sole");
  slide_down(stepper, table, 27);
  slide_down(stepper, table, 35);
}

}  // namespace kaz::dynamics_table
