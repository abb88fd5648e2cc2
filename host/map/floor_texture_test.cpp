// Pictures of a painted floor from two places: how far they are off each other must come out.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/floor_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "host/map/view_testing.h"
#include "shared/base/angle.hpp"
#include "shared/base/random.hpp"

namespace kaz::map {
namespace {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

// Brightness, 0..255, of the floor at a place.
using Paint = std::function<double(const Vector2d&)>;

// Spots of 1 cm and 3 cm.
double carpet(const Vector2d& at, std::uint64_t seed) {
  double value = 128;
  for (const double size : {0.01, 0.03}) {
    const Vector2d grid = at / size;
    const Vector2d low = grid.array().floor();
    const auto spot = [&](double x, double y) {
      return keyed_normal(seed, static_cast<std::uint64_t>(x + 5000),
                          static_cast<std::uint64_t>(y + 5000));
    };
    const double u = grid.x() - low.x(), v = grid.y() - low.y();
    value +=
        20 * std::lerp(std::lerp(spot(low.x(), low.y()), spot(low.x() + 1, low.y()), u),
                       std::lerp(spot(low.x(), low.y() + 1), spot(low.x() + 1, low.y() + 1), u), v);
  }
  return std::clamp(value, 0.0, 255.0);
}
// Alike along x.
double planks(const Vector2d& at) {
  return carpet({0.004, at.y()}, 9);
}

struct Taken {
  vision::Image left;
  vision::PlaneSegments planes;
};

// What an eye at `eye` over the foot sees, the foot at `place` on the floor.
Taken take(const Paint& paint, const Isometry3d& map_from_foot) {
  const Isometry3d foot_from_eye = test_eye(0, 35 * kDegree);
  const TestView view = TestYard{}.seen(foot_from_eye);
  Taken taken{{view.planes.width, view.planes.height, {}}, view.planes};
  taken.planes.info.foot_from_eye = foot_from_eye;
  const vision::CameraModel& c = taken.planes.info.camera;
  const Isometry3d eye = map_from_foot * foot_from_eye;
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      const Vector3d ray = eye.linear() * Vector3d((u - c.cx) / c.fx, (v - c.cy) / c.fy, 1);
      const Vector3d at = eye.translation() - eye.translation().z() / ray.z() * ray;
      const double value = ray.z() < 0 ? paint(at.head<2>()) : 200;
      taken.left.rgb.insert(taken.left.rgb.end(), 3, static_cast<std::uint8_t>(std::lround(value)));
    }
  }
  return taken;
}

Isometry3d foot(double x, double y, double heading_rad) {
  return Eigen::Translation3d(x, y, 0) *
         Isometry3d(Eigen::AngleAxisd(heading_rad, Vector3d::UnitZ()));
}

// The foot that odometry claims for what was taken at `truth`.
std::optional<FloorShift> match(const Paint& paint, const Isometry3d& before,
                                const Isometry3d& truth, const Isometry3d& claimed) {
  const Taken first = take(paint, before), second = take(paint, truth);
  const FloorView view = floor_view({first.left, first.planes, before});
  return FloorMatcher({second.left, second.planes, claimed}, claimed.translation().head<2>())
      .match(view);
}

// Of a turn that moves the square's middle by a cell.
constexpr double kTurnError = FloorView::kCell / 0.55;

const Paint kCarpet = [](const Vector2d& at) { return carpet(at, 3); };

// Walked and turned; odometry errs by some centimetres and degrees.
TEST(FloorTexture, ReportsHowFarOdometryErrs) {
  const Isometry3d before = foot(0, 0, 0);
  const struct {
    Isometry3d truth;
    double dx, dy, turn_deg;
  } cases[] = {{foot(0.30, 0.02, 3 * kDegree), 0.03, -0.02, 2},
               {foot(0.10, -0.05, 30 * kDegree), -0.045, 0.03, -3.5},
               {foot(0, 0, 0), 0, 0, 0},
               {foot(0.2, 0.1, -20 * kDegree), 0.008, 0.05, 5}};
  for (const auto& one : cases) {
    // corrected = shift * turn about the claimed place = truth
    const Vector2d at = one.truth.translation().head<2>() - Vector2d(one.dx, one.dy);
    const double heading = std::atan2(one.truth.linear()(1, 0), one.truth.linear()(0, 0));
    const auto found =
        match(kCarpet, before, one.truth, foot(at.x(), at.y(), heading - one.turn_deg * kDegree));
    ASSERT_TRUE(found) << one.turn_deg;
    EXPECT_NEAR(found->shift.x(), one.dx, 0.004) << one.turn_deg;
    EXPECT_NEAR(found->shift.y(), one.dy, 0.004) << one.turn_deg;
    EXPECT_NEAR(found->turn_rad, one.turn_deg * kDegree, kTurnError) << one.turn_deg;
    EXPECT_GT(found->correlation, 0.5);
    EXPECT_GT(found->overlap_m2, 0.12);
  }
}

// Along the grain nothing says how far: no shift is the likeliest. Across it the shift comes out.
TEST(FloorTexture, ShiftsAcrossPlanksOnly) {
  const Paint paint = [](const Vector2d& at) { return planks(at); };
  const auto found = match(paint, foot(0, 0, 0), foot(0.2, 0.03, 0), foot(0.17, 0.01, 0));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->shift.x(), 0, 0.009);
  EXPECT_NEAR(found->shift.y(), 0.02, 0.006);
  EXPECT_NEAR(found->turn_rad, 0, 0.5 * kDegree);
}

// What is fixed to the picture looks like a robot that has not moved; along the grain nothing contradicts it.
TEST(FloorTexture, WhatIsFixedToThePictureDoesNotPullAlongPlanks) {
  const auto dirty = [](const Isometry3d& at) {
    Taken taken = take([](const Vector2d& place) { return planks(place); }, at);
    const auto width = static_cast<std::size_t>(taken.left.width);
    for (std::size_t i = 0; i < taken.left.rgb.size(); ++i) {
      const std::size_t u = i / 3 % width, v = i / 3 / width;
      const double dirt = 9 * keyed_normal(5, u / 8, v / 8);
      taken.left.rgb[i] =
          static_cast<std::uint8_t>(std::clamp(taken.left.rgb[i] + dirt, 0.0, 255.0));
    }
    return taken;
  };
  const Isometry3d before = foot(0, 0, 0), after = foot(0.05, 0, 0);
  const Taken first = dirty(before), second = dirty(after);
  const auto found = FloorMatcher({second.left, second.planes, after}, {0.05, 0})
                         .match(floor_view({first.left, first.planes, before}));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->shift.x(), 0, 0.008);
  EXPECT_NEAR(found->shift.y(), 0, 0.006);
}

// Where the picture has no depth (here but in an eighth of its columns), the map says what is floor, unless
// the depth says that something else stands there.
TEST(FloorTexture, TakesFloorThatTheMapKnows) {
  const Isometry3d here = foot(0, 0, 0), claimed = foot(0.01, 0, 2 * kDegree);
  const Taken first = take(kCarpet, here);
  const FloorView before = floor_view({first.left, first.planes, here});
  Taken second = take(kCarpet, here);
  TestView seen = TestYard{}.seen(second.planes.info.foot_from_eye);
  LocalMap map = LocalMap::make().value();
  ASSERT_TRUE(map.update(seen.planes, seen.depth, seen.depth.info));
  const int width = second.left.width;
  for (std::size_t i = 0; i < second.planes.label.size(); ++i) {
    if (static_cast<int>(i) % width > width / 8) second.planes.label[i] = 0;
  }
  const auto common = [&](float disparity_px) {
    for (float& d : seen.depth.disparity_px) d = disparity_px;
    FloorMatcher matcher({second.left, second.planes, claimed, &seen.depth, &map}, {0.01, 0});
    return matcher.floor_in_common(before);
  };
  FloorMatcher alone({second.left, second.planes, claimed}, {0.01, 0});
  EXPECT_LT(alone.floor_in_common(before), 0.12);
  EXPECT_FALSE(alone.match(before));
  EXPECT_GT(common(0), 0.25);
  EXPECT_LT(common(90), 0.12) << "something near hides the floor";
  for (float& d : seen.depth.disparity_px) d = 0;
  const auto found =
      FloorMatcher({second.left, second.planes, claimed, &seen.depth, &map}, {0.01, 0})
          .match(before);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->shift.x(), -0.01, 0.003);
  EXPECT_NEAR(found->turn_rad, -2 * kDegree, 0.3 * kDegree);
}

TEST(FloorTexture, FindsNothingWhereNothingIsInCommon) {
  const Isometry3d here = foot(0, 0, 0);
  EXPECT_FALSE(match(kCarpet, here, foot(0, 0, 120 * kDegree), foot(0, 0, 120 * kDegree)))
      << "it looks elsewhere";
  EXPECT_FALSE(match(kCarpet, here, foot(0.2, 0.1, 0), here)) << "too far off";
  EXPECT_FALSE(match([](const Vector2d&) { return 90.0; }, here, here, here)) << "a plain floor";
  const Taken first = take(kCarpet, here);
  const Taken other = take([](const Vector2d& at) { return carpet(at, 77); }, here);
  EXPECT_FALSE(FloorMatcher({other.left, other.planes, here}, {0, 0})
                   .match(floor_view({first.left, first.planes, here})))
      << "another carpet";
}

}  // namespace
}  // namespace kaz::map
