// Free joints against school mechanics: a pendulum's period, the energy of a swinging chain.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "sim/body/world/plain_models_testing.h"
#include "sim/body/world/staged_world.h"

namespace kaz::sim {
namespace {

constexpr double kG = 9.81;
constexpr double kStep = 1e-3;
using test::kFreeRotor;
using test::kRodInertia;
using test::kRodLength;
using test::kRodMass;
using test::kRodSlim;

class ClosedSystem : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<World> load(int rods, const Eigen::Vector3d& gravity) {
    WorldOptions options;
    options.dynamics = GetParam();
    options.step_s = kStep;
    WorldModel around;
    around.gravity = gravity;
    auto world = make_world(around, test::chain(rods, true), test::free_motor(), options);
    EXPECT_TRUE(world) << world.error().message;
    return world ? std::move(*world) : nullptr;
  }
};

INSTANTIATE_TEST_SUITE_P(Dynamics, ClosedSystem, testing::Values("quick50", "exact", "reduced"));

// Gravity turned by the amplitude: the rod starts at rest so far from where it would hang.
//
// The scheme is semi-implicit and symmetric over a swing: its period errs by some (w h)^2, w being the
// frequency, 7.2 /s: 5e-5. The turning point, read once a step, is missed by less than (w h)^2 / 8.
TEST_P(ClosedSystem, PendulumHasThePeriodOfTheEllipticIntegral) {
  for (const double amplitude : {0.05, 0.5, 1.2}) {
    const auto world = load(1, {0, kG * std::sin(amplitude), -kG * std::cos(amplitude)});
    ASSERT_TRUE(world);
    const std::vector<MotorDrive> open(1);
    std::vector<double> crossings;  // of the lowest point
    double last = 0, furthest = 0;
    while (crossings.size() < 11 && world->time_s() < 30) {
      world->step(open, 10.0);
      const double angle = world->joints()[0].angle;
      if ((last < amplitude) != (angle < amplitude)) {
        const double share = (amplitude - last) / (angle - last);
        crossings.push_back(world->time_s() - kStep * (1 - share));
      }
      furthest = std::max(furthest, angle);
      last = angle;
    }
    ASSERT_EQ(crossings.size(), 11u);
    const double arm = kRodLength / 2, inertia = kRodInertia + kRodMass * arm * arm + kFreeRotor;
    const double rate = std::sqrt(kRodMass * kG * arm / inertia);
    const double expected = 4 / rate * std::comp_ellint_1(std::sin(amplitude / 2));
    const double period = (crossings[10] - crossings[0]) / 5;
    std::printf("%s, %.2f rad: period off by %+.1e, amplitude by %+.1e\n", GetParam(), amplitude,
                period / expected - 1, furthest / (2 * amplitude) - 1);
    EXPECT_NEAR(period, expected, 1e-4 * expected) << amplitude;
    EXPECT_NEAR(furthest - amplitude, amplitude, 5e-5 * amplitude);
  }
}

// Four rods, thrown sideways and turned in each other, no motor driven: after 20 s, some thirty swings,
// kinetic and potential energy (rotors included) are what they were.
//
// A step turns a rod by up to w h = 2 %, and the solver holds joints and axes where they were at its
// start: what is lost or made there is of second order, 4e-4 of the energy that moves, and need not
// cancel; ODE's correction of the joints puts some of it back. Solved exactly, 1e-3 must hold over the
// whole run; fifty iterations leave a tenth of a percent of each step's force besides, of either sign:
// 1e-2.
TEST_P(ClosedSystem, ChainKeepsItsEnergy) {
  constexpr std::size_t rods = 4;
  const Eigen::Vector3d gravity(kG * 0.5, kG * 0.6, -kG * std::sqrt(1 - 0.25 - 0.36));
  const auto world = load(rods, gravity);
  ASSERT_TRUE(world);
  const std::vector<MotorDrive> open(rods);
  const Eigen::Vector3d centre(0, 0, -kRodLength / 2);
  const Eigen::Matrix3d own = Eigen::Vector3d(kRodInertia, kRodInertia, kRodSlim).asDiagonal();
  using Poses = std::array<Eigen::Isometry3d, rods>;
  const auto poses = [&] {
    Poses now;
    for (std::size_t i = 0; i < rods; ++i) now[i] = world->link_pose("rod" + std::to_string(i));
    return now;
  };
  Poses before = poses();
  double start = 0, min = 0, max = 0, moves = 0, fastest = 0;
  for (const auto& pose : before) start -= kRodMass * gravity.dot(pose * centre);
  while (world->time_s() < 20) {
    world->step(open, 10.0);
    const Poses now = poses();
    // Speeds from the poses, so that they belong to the middle of the step, and so does the height.
    double kinetic = 0, potential = 0;
    for (std::size_t i = 0; i < rods; ++i) {
      const Eigen::Vector3d v = (now[i] * centre - before[i] * centre) / kStep;
      const Eigen::AngleAxisd turn(before[i].linear().transpose() * now[i].linear());
      const Eigen::Vector3d w = turn.axis() * turn.angle() / kStep;
      const double joint = world->joints()[i].velocity;
      kinetic += 0.5 * (kRodMass * v.squaredNorm() + w.dot(own * w) + kFreeRotor * joint * joint);
      potential -= 0.5 * kRodMass * gravity.dot(now[i] * centre + before[i] * centre);
      fastest = std::max(fastest, w.norm());
    }
    before = now;
    moves = std::max(moves, kinetic);
    min = std::min(min, kinetic + potential - start);
    max = std::max(max, kinetic + potential - start);
  }
  std::printf("%s: %.3f J move, %.1f rad/s; of them %+.1e to %+.1e\n", GetParam(), moves, fastest,
              min / moves, max / moves);
  EXPECT_GT(moves, 0.4);
  EXPECT_LT(fastest * kStep, 0.02);
  const double share = std::string(GetParam()) == "quick50" ? 1e-2 : 1e-3;
  EXPECT_GT(min, -share * moves);
  EXPECT_LT(max, share * moves);
}

}  // namespace
}  // namespace kaz::sim
