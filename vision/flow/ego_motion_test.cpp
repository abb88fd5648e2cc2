// Residuals and normal equations of many samples beside the formula for one, with vectors and without.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/ego_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "shared/base/random.hpp"
#include "vision/flow/cell_disparity.h"
#include "vision/image/pictures_testing.h"

namespace kaz::vision {
namespace {

using Eigen::Vector2d;

struct EgoMotionRows : ::testing::Test {
  Random random{5};
  FrameInfo before = test_info(test_camera()), after = before;
  FlowSamples samples;

  double between(double low, double high) { return low + (high - low) * random.uniform(); }

  void SetUp() override {
    after.foot_from_eye = Eigen::Translation3d(0.05, -0.04, 0.03) *
                          Eigen::AngleAxisd(0.03, Eigen::Vector3d(1, 2, 3).normalized()) *
                          before.foot_from_eye;
    const EgoMotion eye(before, after);
    samples.resize(1003);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double w = between(0, 3);
      // Intervals of one depth; points behind the later eye; numbers that are none.
      const double wider = i % 5 == 0 ? 0 : i % 7 == 0 ? -500 : between(0, 2);
      const double u = between(0, 319), v = between(0, 239);
      Vector2d rest(0, 0);
      eye.flow(u, v, w + between(-0.5, 1.5) * wider, rest);
      if (i % 101 == 0) rest.x() = std::numeric_limits<double>::quiet_NaN();
      samples.set(i, u, v, rest.x() + between(-2, 2), rest.y() + between(-2, 2), w, w + wider);
    }
  }
};

TEST_F(EgoMotionRows, ResidualsAreThoseOfSingleSamples) {
  const EgoMotion eye(before, after);
  int valid = 0, inner = 0;
  for (const bool vectors : {true, false}) {
    FlowResiduals all;
    find_residuals(samples, before.camera, eye.later(), all, vectors);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (std::isnan(samples.flow_u[i])) continue;
      Vector2d px, epipolar;
      const bool is = eye.residual({{samples.u[i], samples.v[i]},
                                    {samples.flow_u[i], samples.flow_v[i]},
                                    samples.min_inverse_depth[i],
                                    samples.max_inverse_depth[i]},
                                   px, epipolar);
      ASSERT_EQ(all.valid[i] != 0, is) << i;
      if (!is) continue;
      ++valid;
      inner += all.free[i] != 0;
      ASSERT_EQ(Vector2d(all.u[i], all.v[i]), px) << i;
      ASSERT_EQ(all.length[i], px.norm()) << i;
      ASSERT_EQ(Vector2d(all.epipolar_u[i], all.epipolar_v[i]), epipolar) << i;
      ASSERT_EQ(all.free[i] != 0, !epipolar.isZero()) << i;
    }
  }
  EXPECT_GT(valid, 1500);
  EXPECT_LT(valid, 2000);
  EXPECT_GT(inner, 500);
}

TEST_F(EgoMotionRows, NormalEquationsAreTheSums) {
  const CameraModel& c = before.camera;
  FlowResiduals all;
  find_residuals(samples, c, EgoMotion(before, after).later(), all);
  for (std::size_t i = 0; i < samples.size(); i += 101) all.valid[i] = 0;
  constexpr double kCutoff2 = 90;
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vector2d px(all.u[i], all.v[i]);
    const double off = px.squaredNorm() / kCutoff2;
    if (all.valid[i] == 0 || off >= 1) continue;
    const Vector2d to =
        Vector2d(samples.u[i], samples.v[i]) + Vector2d(samples.flow_u[i], samples.flow_v[i]) - px;
    const double x = (to.x() - c.cx) / c.fx, y = (to.y() - c.cy) / c.fy;
    const double w = (samples.min_inverse_depth[i] + samples.max_inverse_depth[i]) / 2;
    Eigen::Matrix<double, 2, 6> j;
    j << -x * y, 1 + x * x, -y, w, 0, -x * w, -1 - y * y, x * y, x, 0, w, -y * w;
    j.row(0) *= c.fx;
    j.row(1) *= c.fy;
    const double weight = (1 - off) * (1 - off);
    if (all.free[i] == 0) {
      h += weight * j.transpose() * j;
      b += weight * j.transpose() * px;
      continue;
    }
    const Vector2d across(-all.epipolar_v[i], all.epipolar_u[i]);
    const Eigen::Matrix<double, 6, 1> g = j.transpose() * across;
    h += weight * g * g.transpose();
    b += weight * across.dot(px) * g;
  }
  const NormalEquations fast = normal_equations(samples, all, c, kCutoff2, true);
  const NormalEquations plain = normal_equations(samples, all, c, kCutoff2, false);
  for (int row = 0; row < 6; ++row) {
    EXPECT_EQ(fast.b[row], plain.b[row]);
    EXPECT_NEAR(fast.b[row], b[row], 1e-9 * h(row, row)) << row;
    for (int column = 0; column <= row; ++column) {
      EXPECT_EQ(fast.h(row, column), plain.h(row, column));
      EXPECT_NEAR(fast.h(row, column), h(row, column), 1e-12 * h.norm()) << row << " " << column;
    }
  }
}

TEST(CellDisparity, IsTheMedianOfTheKnown) {
  Random random(9);
  DepthImage depth{test_info(test_camera(37, 21)), 37, 21, {}};
  for (int i = 0; i < 37 * 21; ++i) {
    // Columns from few known to all; equal numbers among them.
    const bool known = random.uniform() * 37 < i % 37 + 8;
    depth.disparity_px.push_back(known ? static_cast<float>(random.below(20)) + 0.5F : 0.0F);
  }
  std::vector<Eigen::Vector2i> places;
  for (int v = 0; v < 21; ++v)
    for (int u = 0; u < 37; ++u) places.emplace_back(u, v);
  std::vector<float> found(places.size());
  median_disparities(depth, places, found.data());
  int none = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const int u0 = std::clamp(places[i].x() - 2, 0, 33), v0 = std::clamp(places[i].y() - 2, 0, 17);
    std::vector<float> known;
    for (int v = v0; v < v0 + 4; ++v)
      for (int u = u0; u < u0 + 4; ++u)
        if (depth.known(u, v)) known.push_back(depth.disparity(u, v));
    std::sort(known.begin(), known.end());
    none += known.size() < 6;
    ASSERT_EQ(found[i], known.size() < 6 ? 0 : known[known.size() / 2]) << i;
  }
  EXPECT_GT(none, 20);
  EXPECT_LT(none, 400);
}

}  // namespace
}  // namespace kaz::vision
