// Inverse after forward is where it began; what cannot be reached is said.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/inverse.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kaz::motion {
namespace {

// Within the joint's range, and spread over it.
double spread(int joint, int n) {
  const host::JointInfo& info = host::joint_table()[static_cast<std::size_t>(joint)];
  const double share = std::fmod(0.37 + 0.618 * (joint + 1) * n, 1.0);
  return info.lower_rad + share * (info.upper_rad - info.lower_rad);
}

TEST(Inverse, LegsComeBack) {
  int reached = 0;
  for (int n = 1; n <= 200; ++n) {
    for (const Side side : {Side::left, Side::right}) {
      const int first = side == Side::left ? host::l_hip_roll : host::r_hip_roll;
      JointAngles angles{};
      for (int i = 0; i < 4; ++i)
        angles[static_cast<std::size_t>(first + i)] = spread(first + i, n);
      const LegAngles leg = leg_of(angles, side);
      const Eigen::Vector3d ankle =
          forward(angles)[static_cast<std::size_t>(first + 3)].translation();
      // Only postures with the knee bent forward and the foot below the hip.
      if (leg.knee < 0.05 || ankle.z() > -0.01) continue;
      const auto found = leg_to(side, ankle, leg.hip_pitch + leg.knee + leg.ankle_pitch);
      ASSERT_TRUE(found) << n;
      EXPECT_NEAR(found->hip_roll, leg.hip_roll, 1e-9);
      EXPECT_NEAR(found->hip_pitch, leg.hip_pitch, 1e-9);
      EXPECT_NEAR(found->knee, leg.knee, 1e-9);
      EXPECT_NEAR(found->ankle_pitch, leg.ankle_pitch, 1e-9);
      ++reached;
    }
  }
  EXPECT_GT(reached, 150);
}

TEST(Inverse, HandsReachTheirTargets) {
  int reached = 0;
  for (int n = 1; n <= 200; ++n) {
    for (const Side side : {Side::left, Side::right}) {
      const int first = side == Side::left ? host::l_sh_pitch : host::r_sh_pitch;
      JointAngles angles{};
      for (int i = 0; i < 3; ++i)
        angles[static_cast<std::size_t>(first + i)] = spread(first + i, n);
      // The elbow bends forward; a roll beyond a right angle has a twin that is not.
      if (angles[static_cast<std::size_t>(first + 2)] > 0 ||
          std::abs(angles[static_cast<std::size_t>(first + 1)]) > 1.5) {
        continue;
      }
      const Eigen::Vector3d grasp = trunk_from_grasp(angles, side).translation();
      const auto found = arm_to(side, grasp);
      if (!found) continue;
      JointAngles again{};
      set_arm(again, side, *found);
      EXPECT_NEAR((trunk_from_grasp(again, side).translation() - grasp).norm(), 0, 1e-9) << n;
      EXPECT_EQ(within_limits(again), again);
      ++reached;
    }
  }
  EXPECT_GT(reached, 150);
}

TEST(Inverse, RefusesWhatIsOutOfReach) {
  EXPECT_FALSE(leg_to(Side::left, {0, 0.033, -0.131}, 0)) << "longer than the leg";
  EXPECT_FALSE(leg_to(Side::left, {0, 0.033, 0.05}, 0)) << "above the hip";
  EXPECT_FALSE(leg_to(Side::left, {0, 0.153, -0.05}, 0)) << "hip roll's limit is 45 degrees";
  EXPECT_FALSE(leg_to(Side::left, {0, 0.033, -0.12}, 1.6)) << "the ankle's range";
  EXPECT_FALSE(arm_to(Side::right, {0, -0.08, 0.1 - 0.164})) << "longer than the arm";
  EXPECT_FALSE(arm_to(Side::right, {0, -0.08, 0.1 - 0.02})) << "the elbow's range";
}

}  // namespace
}  // namespace kaz::motion
