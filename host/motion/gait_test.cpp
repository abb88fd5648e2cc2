// The pattern keeps its criterion, is smooth and stays within the joints' ranges.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/gait.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace kaz::motion {
namespace {

using Eigen::Vector3d;

// Mass by mass, not as one point: sum of m (z'' + g) y - m y'' z over m (z'' + g), by differences.
double zmp_of_all_masses(const Shape& shape, double roll, double phase) {
  constexpr double kStep = 1e-3;  // s
  struct Moments {
    double y_z = 0, y_f = 0;
  };
  std::array<std::array<Vector3d, KZ_JOINTS + 1>, 3> at;
  for (int i = 0; i < 3; ++i) {
    const double p = phase + (i - 1) * kStep / shape.period;
    JointAngles angles = legs_at(shape, roll, p, {.amplitude = 1});
    // The carrying foot is the one that stands; the trunk from it.
    const bool left = p - std::floor(p) < 0.5;
    const Eigen::Isometry3d sole =
        host::trunk_from_sole(angles, left ? Side::left : Side::right).inverse();
    const Poses poses = forward(angles);
    auto& points = at[static_cast<std::size_t>(i)];
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) points[j] = sole * poses[j] * links()[j].centre;
    points[KZ_JOINTS] = sole * Vector3d(-0.005, 0, 0.05);
  }
  double above = 0, below = 0;
  for (std::size_t j = 0; j <= KZ_JOINTS; ++j) {
    const double mass = j < KZ_JOINTS ? links()[j].mass : kTrunkMass;
    const Vector3d acceleration = (at[2][j] - 2 * at[1][j] + at[0][j]) / (kStep * kStep);
    const double weight = mass * (acceleration.z() + 9.81);
    above += weight * at[1][j].y() - mass * acceleration.y() * at[1][j].z();
    below += weight;
  }
  return above / below;
}

// From the carrying sole's middle: the sole reaches 30 mm to each side. That all links do not move as one
// point costs up to 6 mm of the planned margin of 11.
TEST(Gait, ZeroMomentPointStaysInsideTheCarryingSoleDuringEachSwing) {
  for (const Shape& shape : {Shape{}, Shape{.period = 2.2}}) {
    const double roll = roll_for(shape);
    EXPECT_GT(roll, 10 * kDegree);
    EXPECT_LE(roll, shape.max_roll);
    std::printf("period %.1f s: roll %.1f deg, zero moment point within %.1f mm\n", shape.period,
                roll / kDegree, 1e3 * zmp_amplitude(shape, roll));
    const double from = shape.lag + 0.25 - shape.swing / 2, to = from + shape.swing;
    for (double phase = from; phase <= to; phase += 0.01) {
      const double y = zmp_of_all_masses(shape, roll, phase);
      EXPECT_GT(y, -kHalfSole) << phase;
      EXPECT_LT(y, -kHalfSole + 0.060 - 0.005) << phase;
      const double mirrored = zmp_of_all_masses(shape, roll, phase + 0.5);
      EXPECT_NEAR(mirrored, -y, 1e-6) << phase;
    }
  }
}

TEST(Gait, RollFollowsTheCriterion) {
  const Shape shape;
  const double roll = roll_for(shape);
  EXPECT_NEAR(zmp_amplitude(shape, roll) * std::cos(std::numbers::pi * shape.swing),
              inner_edge(roll) + shape.margin, 1e-6);
  EXPECT_EQ(roll_for({.margin = 0.05}), Shape{}.max_roll) << "more than the body can";
  EXPECT_GT(roll_for({.period = 1.5}), roll) << "slower needs more lean: less is thrown";
}

TEST(Gait, FeetAreFlatAndAtTheirTargets) {
  for (const double roll : {-20.0, 0.0, 13.0}) {
    const Stance stance{.x = -0.01, .z = 0.14, .pitch = 6 * kDegree, .roll = roll * kDegree};
    JointAngles angles = home();
    place_legs(angles, stance, {0.018, 0.008, -0.015, 0});
    Eigen::Isometry3d trunk = Eigen::Isometry3d::Identity();
    trunk.translation() = Vector3d(stance.x, 0, stance.z);
    trunk.rotate(Eigen::AngleAxisd(stance.pitch, Vector3d::UnitY()));
    trunk.rotate(Eigen::AngleAxisd(stance.roll, Vector3d::UnitX()));
    for (const Side side : {Side::left, Side::right}) {
      const bool left = side == Side::left;
      const Eigen::Isometry3d sole = trunk * host::trunk_from_sole(angles, side);
      EXPECT_NEAR(sole.translation().x(), left ? 0.018 : -0.015, 1e-9);
      EXPECT_NEAR(sole.translation().z(), left ? 0.008 : 0, 1e-9);
      EXPECT_NEAR((sole.linear() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-9);
    }
  }
}

// 12 rad/s is what the motors do unloaded; at 100 Hz that is 0.12.
TEST(Gait, IsSmoothAndWithinTheRanges) {
  for (const Shape& shape : {Shape{}, Shape{.period = 2.2}}) {
    const double roll = roll_for(shape);
    for (const Steps& steps : {Steps{1, 0.055, 0.025, 0, 0}, Steps{1, 0, 0, 0.012, 0},
                               Steps{1, -0.04, -0.04, 0, 0.05}, Steps{0.5, 0.04, 0.04, 0, 0}}) {
      JointAngles before = legs_at(shape, roll, 0, steps);
      for (int i = 1; i <= 300; ++i) {
        const JointAngles now = legs_at(shape, roll, 0.01 * i / shape.period, steps);
        EXPECT_EQ(within_limits(now), now) << i;
        for (std::size_t j = 0; j < now.size(); ++j)
          EXPECT_LT(std::abs(now[j] - before[j]), 0.12) << i << " " << j;
        before = now;
      }
    }
    // Standing is the crouch at every phase.
    EXPECT_EQ(legs_at(shape, roll, 0.3, {}), home());
  }
}

}  // namespace
}  // namespace kaz::motion
