// The pose filter: closed forms of one match, of a loop, of a wrong match.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/pose_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shared/base/angle.hpp"
#include "shared/base/random.hpp"

namespace kaz::map {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

Matrix3d noise(double m, double rad) {
  return Vector3d(m * m, m * m, rad * rad).asDiagonal();
}

TEST(PoseFilter, PosesAreSeenFromEachOther) {
  const Vector3d a(1, 2, 90 * kDegree), b(1, 3, 180 * kDegree);
  EXPECT_TRUE(pose_between(a, b).isApprox(Vector3d(1, 0, 90 * kDegree), 1e-12));
  EXPECT_TRUE(pose_after(a, pose_between(a, b)).isApprox(b, 1e-12));
}

// Before any match the pose is odometry's, the further it went the less certain.
TEST(PoseFilter, FollowsOdometry) {
  PoseFilter filter;
  filter.move({0.1, 0, 0});
  filter.move({0.5, 0, 0});
  const double near = filter.covariance()(0, 0);
  filter.move({1.1, 0, 0.5});
  EXPECT_TRUE(filter.pose().isApprox(Vector3d(1.1, 0, 0.5), 1e-12));
  EXPECT_GT(filter.covariance()(0, 0), near);
  EXPECT_GT(filter.covariance()(1, 1), filter.covariance()(0, 0)) << "the heading's error sways it";
  EXPECT_TRUE(filter.at({1.2, 0, 0.5}).isApprox(Vector3d(1.2, 0, 0.5), 1e-12));
}

// A perfect match with the start puts a pose right, and with it the one that was remembered on the way.
TEST(PoseFilter, CorrectsAlsoThePosesOnTheWay) {
  PoseFilter filter;
  filter.move({0, 0, 0});
  const int start = filter.remember();
  filter.move({0.5, 0, 0});
  const int half = filter.remember();
  filter.move({1.0, 0, 0});
  ASSERT_TRUE(filter.measure(start, {1.02, 0, 0}, noise(1e-6, 1e-6)));
  EXPECT_NEAR(filter.pose().x(), 1.02, 1e-6);
  EXPECT_NEAR(filter.remembered(half).x(), 0.51, 1e-6) << "half of the way, half of the error";
  EXPECT_NEAR(filter.remembered(start).x(), 0, 1e-9) << "the start is certain";
  EXPECT_NEAR(filter.at({1.1, 0, 0}).x(), 1.12, 1e-6) << "and odometry goes on from there";
}

// Of two estimates as uncertain as each other the mean, with half the variance.
TEST(PoseFilter, WeighsAMatchByItsNoise) {
  PoseFilter filter;
  filter.move({0, 0, 0});
  const int start = filter.remember();
  filter.move({0.3, 0, 0});
  const Matrix3d before = filter.covariance();
  ASSERT_TRUE(filter.measure(start, {0.306, 0, 0}, before));
  EXPECT_NEAR(filter.pose().x(), 0.303, 1e-9);
  EXPECT_NEAR(filter.covariance()(0, 0), before(0, 0) / 2, 1e-12);
}

TEST(PoseFilter, RefusesAnotherSquareOfTheFloor) {
  PoseFilter filter;
  filter.move({0, 0, 0});
  const int start = filter.remember();
  filter.move({0.3, 0, 0});
  EXPECT_FALSE(filter.measure(start, {0.35, 0, 0}, noise(0.004, 0.01)));
  EXPECT_FALSE(filter.measure(start, {0.3, 0, 8 * kDegree}, noise(0.004, 0.01)));
  EXPECT_EQ(filter.pose().x(), 0.3);
  EXPECT_TRUE(filter.measure(start, {0.31, 0, 1 * kDegree}, noise(0.004, 0.01)));
}

TEST(PoseFilter, WhereTheRobotStandsIsRememberedOnce) {
  PoseFilter filter;
  filter.move({0, 0, 0});
  const int first = filter.remember();
  filter.move({0.001, 0, 0});
  EXPECT_EQ(filter.remember(), first);
  filter.move({0.1, 0, 0});
  EXPECT_EQ(filter.remember(), first + 1);
}

// 400 robots go around a square of half a metre with errors as large as the filter takes odometry's to be,
// and look at the last two corners each time: the error is what the filter claims (normalized squared error
// of three: mean 3, one sigma of the mean 0.12), and less than without looks.
TEST(PoseFilter, KnowsHowFarItIsOff) {
  double sum = 0, looked = 0, blind = 0;
  constexpr int kSeeds = 400;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    std::uint64_t drawn = 0;
    const auto normal = [&](double sigma) { return sigma * keyed_normal(5, seed, drawn++); };
    PoseFilter filter, without;
    Vector3d truth(0, 0, 0), odometry = truth;
    std::vector<Vector3d> places;
    std::vector<int> numbers;
    for (int leg = 0; leg <= 8; ++leg) {
      filter.move(odometry);
      without.move(odometry);
      for (std::size_t k = places.size() < 2 ? 0 : places.size() - 2; k < places.size(); ++k) {
        Vector3d seen = pose_between(places[k], truth);
        seen += Vector3d(normal(0.004), normal(0.004), normal(0.6 * kDegree));
        filter.measure(numbers[k], seen, noise(0.004, 0.6 * kDegree));
      }
      numbers.push_back(filter.remember());
      places.push_back(truth);
      const Vector3d step = leg % 2 == 0 ? Vector3d(0.5, 0, 0) : Vector3d(0, 0, 90 * kDegree);
      truth = pose_after(truth, step);
      const double way = step.head<2>().norm(), turn = std::abs(step.z());
      const double place = std::sqrt(1e-4 * way + 25e-6 * turn);
      const double heading = kDegree * std::sqrt(2.25 * way + turn);
      odometry =
          pose_after(odometry, step + Vector3d(normal(place), normal(place), normal(heading)));
    }
    const Vector3d off = filter.pose() - places.back();
    sum += off.dot(filter.covariance().inverse() * off) / kSeeds;
    looked += off.head<2>().norm() / kSeeds;
    blind += (without.pose() - places.back()).head<2>().norm() / kSeeds;
  }
  EXPECT_NEAR(sum, 3, 0.5);
  EXPECT_LT(looked, 0.6 * blind);
}

}  // namespace
}  // namespace kaz::map
