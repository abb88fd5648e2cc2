// Odometry of planned steps, and the gyro's zero.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/odometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/motion/gait.h"
#include "host/motion/heading.h"
#include "shared/base/random.hpp"

namespace kaz::motion {
namespace {

// A cycle moves the body by L / (1 - swing): the stance foot goes back by L in that share of it, and the
// two supports overlap.
TEST(Odometry, CountsWhatTheCarryingFeetDo) {
  const Shape shape;
  const double roll = roll_for(shape);
  Odometry odometry;
  for (int i = 0; i <= 1000; ++i) {
    const double phase = 0.01 * i;
    odometry.add(legs_at(shape, roll, phase, {.amplitude = 1, .left = 0.04, .right = 0.04}),
                 left_share(shape, phase, 1), 0.3, 0.01);
  }
  const double expected = 10 * 0.04 / (1 - shape.swing);
  EXPECT_NEAR(odometry.walked(), expected, 0.005);
  EXPECT_NEAR(odometry.place().x, expected * std::cos(0.3), 0.03);
  EXPECT_NEAR(odometry.place().y, expected * std::sin(0.3), 0.03);
  EXPECT_NEAR(odometry.place().sigma_along, 0.015 * expected, 0.0015);
  EXPECT_GT(odometry.place().sigma_across, odometry.place().sigma_along);
}

host::Inertial sample(double time_s, double rate) {
  return {.time = from_seconds(time_s), .yaw_rate_rad_per_s = rate};
}

TEST(Heading, IntegratesWithoutTheZero) {
  constexpr double kZero = 0.5;
  Heading heading;
  int i = 0;
  for (; i < 200; ++i) heading.add(sample(0.01 * i, kZero), true, 1);
  EXPECT_NEAR(heading.zeroed_s(), 1.99, 0.02);
  for (; i < 300; ++i)
    heading.add(sample(0.01 * i, kZero + 0.4 * std::cos(0.1)), false, std::cos(0.1));
  EXPECT_NEAR(heading.rad(), 0.4, 0.005);
  EXPECT_GT(heading.sigma_rad(), 0);
  const double before = heading.rad();
  // A link that was lost for a while: nobody knows what it turned, and no step is invented.
  heading.add(sample(9.0, kZero + 1), false, 1);
  EXPECT_EQ(heading.rad(), before);
}

// 4 s of standing, 20 s of going, 4 s of standing, with a zero that walks at random and noise in each
// sample: by how much is the heading off, in sigmas, and in degrees?
struct Off {
  double sigmas_before = 0, sigmas_after = 0, before_deg = 0, after_deg = 0;
};
Off walk_with_a_wandering_zero(std::uint64_t seed) {
  constexpr double kDt = 0.0125, kNoise = 0.13 * kDegree, kWander = 0.022 * kDegree;
  Heading heading;
  double zero = 20 * kDegree * keyed_normal(seed, 0, 1), truth = 0;
  Off off;
  for (int i = 0; i < 2240; ++i) {
    const bool still = i < 320 || i >= 1920;
    const double rate = still ? 0 : 0.2 * std::sin(0.01 * i);
    const auto number = static_cast<std::uint64_t>(i);
    zero += kWander * std::sqrt(kDt) * keyed_normal(seed, number, 2);
    truth += rate * kDt;
    const double noise = kNoise / std::sqrt(2 * kDt) * keyed_normal(seed, number, 3);
    heading.add(sample(kDt * i, zero + rate + noise), still, 1);
    if (i == 1919) {
      off.before_deg = (heading.rad() - truth) / kDegree;
      off.sigmas_before = (heading.rad() - truth) / heading.sigma_rad();
    }
  }
  off.after_deg = (heading.rad() - truth) / kDegree;
  off.sigmas_after = (heading.rad() - truth) / heading.sigma_rad();
  return off;
}

// 400 seeds know a sigma to 3.5 %; three of that. By hand: before the second stand the zero is known to
// 0.13 / sqrt(8), makes 0.92 in 20 s; wandering 0.022 sqrt(20^3 / 3) = 1.14, the noise 0.41: 1.5 degrees.
// The heading at the end of the walk has half of that error.
TEST(Heading, KnowsHowSureItIsAndLearnsWhenItStandsAgain) {
  constexpr int kSeeds = 400;
  double before = 0, after = 0, before_deg = 0, after_deg = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Off off = walk_with_a_wandering_zero(seed);
    before += off.sigmas_before * off.sigmas_before / kSeeds;
    after += off.sigmas_after * off.sigmas_after / kSeeds;
    before_deg += off.before_deg * off.before_deg / kSeeds;
    after_deg += off.after_deg * off.after_deg / kSeeds;
  }
  EXPECT_NEAR(std::sqrt(before), 1, 0.11);
  EXPECT_NEAR(std::sqrt(after), 1, 0.11);
  EXPECT_NEAR(std::sqrt(before_deg), 1.5, 0.2);
  EXPECT_LT(std::sqrt(after_deg), 0.7 * std::sqrt(before_deg));
}

// Pushed while it stands: that is a turn, not the zero.
TEST(Heading, IsNotFooledByAPushWhileStanding) {
  Heading heading;
  int i = 0;
  for (; i < 400; ++i) heading.add(sample(0.01 * i, 0.2), true, 1);
  for (; i < 420; ++i) heading.add(sample(0.01 * i, 0.2 + 1), true, 1);
  for (; i < 800; ++i) heading.add(sample(0.01 * i, 0.2), true, 1);
  EXPECT_NEAR(heading.rad(), 0.2, 0.01);
}

}  // namespace
}  // namespace kaz::motion
