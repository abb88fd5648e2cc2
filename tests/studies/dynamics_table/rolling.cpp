// A ball that rolls down, that slips until it rolls, that is slowed by rolling resistance.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/studies/dynamics_table/scene.h"

namespace kaz::dynamics_table {
namespace {

constexpr double kRadius = 0.02, kMass = 0.015;

// A robot of one link: it can be pushed, and is never put to sleep.
std::unique_ptr<sim::StagedWorld> ball_on(const std::string& stepper, double slope, double mu,
                                          double resistance) {
  const sim::Surface surface{.mu = mu, .rolling_resistance = resistance};
  return world_of(stepper, sim::test::floor_of({.mu = 1}, on_slope(slope)),
                  sim::test::lone(sim::test::ball("ball", kMass, kRadius, surface)),
                  sim::test::free_motor());
}

double along(const sim::World& world) {
  return world.link_pose("ball").translation().x();
}

// Mean over the next 50 ms.
double speed(sim::World& world) {
  const double from = along(world);
  run(world, 0.05);
  return (along(world) - from) / 0.05;
}

}  // namespace

void roll(const std::string& stepper, Table& table) {
  {
    const double slope = 10 * M_PI / 180, acceleration = 5.0 / 7 * kG * std::sin(slope);
    const auto world = ball_on(stepper, slope, 0.5, 0);
    std::array<double, 3> at{};
    for (double& x : at) {
      run(*world, 0.5);
      x = along(*world);
    }
    table.put(stepper, "ball rolls down 10°", "acceleration",
              value("5/7 g sin a = %.4f m/s²", acceleration), "",
              (at[2] - 2 * at[1] + at[0]) / 0.25 / acceleration - 1);
  }
  {
    constexpr double mu = 0.2, start = 0.35;
    const auto world = ball_on(stepper, 0, mu, 0);
    run(*world, 0.3);
    const double from = along(*world);
    static_cast<void>(world->push("ball", {kMass * start, 0, 0}));
    run(*world, 0.5);
    const double at = along(*world), end = speed(*world);
    const double rolls = 5.0 / 7 * start;
    const double slips = 2 * start / (7 * mu * kG);  // s, until it rolls
    const double distance = (start + rolls) / 2 * slips + rolls * (0.5 - slips);
    const std::string scene = "ball pushed to 0.35 m/s, mu 0.2";
    table.put(stepper, scene, "speed once it rolls", value("5/7 v = %.3f m/s", rolls), "",
              end / rolls - 1);
    table.put(stepper, scene, "distance in 0.5 s, slipping for 2v/(7 mu g) of it",
              value("%.4f m", distance), "", (at - from) / distance - 1);
  }
  {
    constexpr double rho = 0.0005;
    const double slower = rho * kG / (1.4 * kRadius);
    const auto world = ball_on(stepper, 0, 1, rho);
    run(*world, 0.3);
    static_cast<void>(world->push("ball", {kMass * 0.35, 0, 0}));
    run(*world, 0.2);
    const double before = speed(*world);
    run(*world, 0.45);
    const double after = speed(*world);
    table.put(stepper, "ball with rolling resistance 0.5 mm", "deceleration",
              value("rho g/(7/5 r) = %.4f m/s²", slower), "", (before - after) / 0.5 / slower - 1);
    run(*world, 2.0);
    const double rest = along(*world);
    run(*world, 5.0);
    table.put(stepper, "ball with rolling resistance 0.5 mm", "creep in 5 s at rest", "none", "m",
              along(*world) - rest);
  }
}

}  // namespace kaz::dynamics_table
