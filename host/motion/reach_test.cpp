// The hand gets where it is sent, the weight stays over the soles, and both sides are alike.
// SPDX-License-Identifier: Apache-2.0
#include "host/motion/reach.h"

#include <cmath>

#include <gtest/gtest.h>

namespace kaz::motion {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

// The foot's axes are the floor's: what it sees of the hand is where the hand is over the floor.
Vector3d over_floor(const JointAngles& angles, const Vector3d& in_trunk) {
  const Vector3d middle = host::trunk_from_sole(angles, Side::left).inverse() * in_trunk;
  return middle + Vector3d(0, host::kLeg.hip_y, 0);
}

TEST(Pickup, ReachesWhatTheApproachDelivers) {
  for (const double radius : {0.018, 0.020}) {
    for (double x = 0.080; x < 0.121; x += 0.010) {
      for (double y = -0.070; y < -0.019; y += 0.010) {
        const auto plan = Pickup::plan(Side::right, {x, y}, radius);
        ASSERT_TRUE(plan) << x << " " << y;
        const JointAngles angles = plan->at(plan->down_s());
        const Vector3d grasp =
            over_floor(angles, trunk_from_grasp(angles, Side::right).translation());
        EXPECT_NEAR(grasp.x(), x, 1e-4) << x << " " << y;
        EXPECT_NEAR(grasp.y(), y + 0.012, 1e-4);
        EXPECT_NEAR(grasp.z(), radius + 0.003, 1e-4);
      }
    }
  }
}

TEST(Pickup, KeepsTheWeightOverTheSolesAndTheSolesFlat) {
  const auto plan = Pickup::plan(Side::left, {0.095, 0.05}, 0.020);
  ASSERT_TRUE(plan);
  for (double t = 0; t <= plan->end_s(); t += 0.05) {
    const JointAngles angles = plan->at(t);
    const Vector3d weight = over_floor(angles, centre_of_mass(angles));
    // Two centimetres from heel and toe; the arm moves it little to the side.
    EXPECT_GT(weight.x(), kHeel + 0.02) << t;
    EXPECT_LT(weight.x(), kToe - 0.02) << t;
    EXPECT_LT(std::abs(weight.y()), 0.02) << t;
    const Eigen::Isometry3d left = host::trunk_from_sole(angles, Side::left);
    const Eigen::Isometry3d right = host::trunk_from_sole(angles, Side::right);
    EXPECT_LT((left.inverse() * right).translation().head<1>().norm(), 1e-6) << t;
    EXPECT_NEAR((left.linear() - right.linear()).norm(), 0, 1e-9);
  }
}

// The pose that was found by search when the body was designed; 0.1 degrees is its rounding.
TEST(Pickup, BendsAsWasFound) {
  const auto plan = Pickup::plan(Side::right, {0.100, -0.055}, 0.020);
  ASSERT_TRUE(plan);
  const JointAngles bent = plan->at(plan->down_s());
  EXPECT_NEAR(bent[host::r_hip_pitch] / kDegree, -115.1, 0.1);
  EXPECT_NEAR(bent[host::r_knee] / kDegree, 101.0, 0.1);
  EXPECT_NEAR(bent[host::r_ankle_pitch] / kDegree, -35.9, 0.1);
  EXPECT_NEAR(bent[host::r_sh_pitch] / kDegree, -58.4, 0.1);
  EXPECT_NEAR(bent[host::r_sh_roll] / kDegree, 13.3, 0.1);
  EXPECT_NEAR(bent[host::r_elbow] / kDegree, -13.5, 0.1);
}

TEST(Pickup, SidesAreAlike) {
  const auto right = Pickup::plan(Side::right, {0.1, -0.05}, 0.018);
  const auto left = Pickup::plan(Side::left, {0.1, 0.05}, 0.018);
  ASSERT_TRUE(right && left);
  for (double t = 0; t <= right->end_s(); t += 0.1) {
    const JointAngles a = right->at(t), b = left->at(t);
    EXPECT_NEAR(a[host::r_sh_pitch], b[host::l_sh_pitch], 1e-9);
    EXPECT_NEAR(a[host::r_sh_roll], -b[host::l_sh_roll], 1e-9);
    EXPECT_NEAR(a[host::r_elbow], b[host::l_elbow], 1e-9);
    EXPECT_NEAR(a[host::r_hand], b[host::l_hand], 1e-9);
    EXPECT_NEAR(a[host::l_knee], b[host::l_knee], 1e-9);
  }
  EXPECT_GT(right->closed(), right->stopped() + 8 * kDegree);
}

// The return is smooth from wherever the pickup is aborted: at most 6 degrees a joint in a cycle of 20 ms.
TEST(Pickup, GoesBackSmoothly) {
  const auto plan = Pickup::plan(Side::right, {0.11, -0.06}, 0.020);
  ASSERT_TRUE(plan);
  for (const double from : {plan->bent_s(), plan->down_s(), plan->lifted_s(), plan->end_s()}) {
    JointAngles last = plan->at(from);
    for (double t = 0; t <= Pickup::kGiveUp_s + 0.02; t += 0.02) {
      const JointAngles now = plan->back(from, t);
      for (std::size_t j = 0; j < now.size(); ++j)
        ASSERT_LT(std::abs(now[j] - last[j]), 6 * kDegree) << from << " " << t << " joint " << j;
      last = now;
    }
    const JointAngles stand = home();
    for (std::size_t j = 0; j < stand.size(); ++j)
      EXPECT_NEAR(last[j], j == host::r_hand ? 0 : stand[j], 0.01) << j;
  }
}

TEST(Pickup, SaysWhatIsOutOfReach) {
  EXPECT_FALSE(Pickup::plan(Side::right, {0.25, -0.05}, 0.020));
  EXPECT_FALSE(Pickup::plan(Side::right, {0.10, 0.15}, 0.020));
  const auto plan = Pickup::plan(Side::right, {0.10, -0.05}, 0.020);
  ASSERT_TRUE(plan);
  EXPECT_FALSE(plan->aimed_at({0.3, 0}));
  const auto moved = plan->aimed_at({0.11, -0.06});
  ASSERT_TRUE(moved);
  const JointAngles angles = moved->at(moved->down_s());
  EXPECT_NEAR(over_floor(angles, trunk_from_grasp(angles, Side::right).translation()).x(), 0.11,
              1e-4);
}

}  // namespace
}  // namespace kaz::motion
