// Odometry of planned steps, and the gyro's zero.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/odometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/motion/gait.h"
#include "host/motion/heading.h"

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
  EXPECT_NEAR(odometry.place().sigma_along, 0.03 * expected, 0.003);
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

// Mean over 2 s of 0.1 degrees/s per root Hz is off by 0.05 degrees/s; 30 s later that is 1.5 degrees.
TEST(Heading, KnowsHowSureItIs) {
  Heading heading;
  int i = 0;
  for (; i <= 200; ++i) heading.add(sample(0.01 * i, 0), true, 1);
  for (; i <= 3200; ++i) heading.add(sample(0.01 * i, 0), false, 1);
  EXPECT_NEAR(heading.sigma_rad() / kDegree, 1.55, 0.1);
}

}  // namespace
}  // namespace kaz::motion
