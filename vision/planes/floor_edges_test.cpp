// The floor's edges in pictures whose true edges are known, from labels that are off.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/floor_edges.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "shared/base/random.hpp"

namespace kaz::vision {
namespace {

constexpr int kWidth = 160, kHeight = 120;

// A floor of low grain; a box of another colour on it, right of u = 60 and above v = 70.
bool on_box(int u, int v) {
  return u >= 60 && v < 70;
}

Image picture() {
  Image image{kWidth, kHeight, {}};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const auto at = static_cast<std::uint64_t>(v * kWidth + u);
      const double grain = 8 * std::sin(0.7 * u) * std::sin(0.5 * v) + 2 * keyed_normal(4, 0, at);
      for (const double base :
           on_box(u, v) ? std::array{70.0, 90.0, 130.0} : std::array{150.0, 120.0, 90.0})
        image.rgb.push_back(static_cast<std::uint8_t>(std::lround(base + grain)));
    }
  }
  return image;
}

// The floor's border moved by `shift` px; with `holes`, one pixel in 20 has no depth.
PlaneSegments planes(int shift, bool holes) {
  PlaneSegments planes;
  planes.width = kWidth;
  planes.height = kHeight;
  planes.segments.resize(2);
  planes.segments[0].pixels = 500;
  planes.segments[1].floor = true;
  planes.segments[0].middle = planes.segments[1].middle = {0, 0, 1};
  planes.segments[1].normal = {0, 0, -1};
  planes.segments[1].distance_m = 1;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const bool hole = holes && keyed_normal(9, static_cast<std::uint64_t>(v),
                                              static_cast<std::uint64_t>(u)) > 1.645;
      const bool floor = !hole && !on_box(u + shift, v - shift);
      planes.label.push_back(floor ? 2 : on_box(u, v) && !hole ? 1 : 0);
    }
  }
  return planes;
}

int wrong(const PlaneSegments& planes) {
  int n = 0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u)
      n += (planes.label[static_cast<std::size_t>(v * kWidth + u)] == 2) == on_box(u, v) ? 1 : 0;
  }
  return n;
}

TEST(FloorEdges, AreWhereThePictureChanges) {
  const Image image = picture();
  FloorEdges edges;
  for (const int shift : {-7, -4, 0, 4, 7}) {
    PlaneSegments found = planes(shift, false);
    const int before = wrong(found);
    ASSERT_TRUE(edges.sharpen(image, found));
    // The border is 170 px long and the line between both sides one wide.
    EXPECT_LE(wrong(found), 175) << shift << ", before: " << before;
    if (std::abs(shift) >= 4) {
      EXPECT_LT(3 * wrong(found), before) << shift;
    }
  }
}

TEST(FloorEdges, HolesInTheDepthOfTheFloorAreClosed) {
  PlaneSegments found = planes(5, true);
  FloorEdges edges;
  ASSERT_TRUE(edges.sharpen(picture(), found));
  EXPECT_LE(wrong(found), 200);
}

TEST(FloorEdges, NothingHappensWithoutFloorOrFarFromItsBorder) {
  const Image image = picture();
  FloorEdges edges;
  PlaneSegments none = planes(3, false);
  none.segments[1].floor = false;
  const auto before = none.label;
  ASSERT_TRUE(edges.sharpen(image, none));
  EXPECT_EQ(none.label, before);
  PlaneSegments some = planes(3, false);
  const auto labels = some.label;
  ASSERT_TRUE(edges.sharpen(image, some));
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      if (std::abs(u - 57) <= 9 || std::abs(v - 73) <= 9) continue;
      const auto at = static_cast<std::size_t>(v * kWidth + u);
      ASSERT_EQ(some.label[at], labels[at]) << u << " " << v;
    }
  }
}

// A can of 7 x 14 px that stands on the floor at v = 100, as block matching sees it: 4 px wider to all sides.
// Without depth, or with that of the floor, it is a hole to be closed.
TEST(FloorEdges, NarrowThingsThatStandAreNoFloor) {
  const auto on_can = [](int u, int v, int wider) {
    return u >= 30 - wider && u < 37 + wider && v >= 86 - wider && v < 100 + wider;
  };
  Image image = picture();
  PlaneSegments seen = planes(0, false);
  CameraModel& camera = seen.info.camera;
  camera = {kWidth, kHeight, 140, 140, 79.5, 59.5, 0.06};
  // The eye is 0.3 m above the floor and looks 30 degrees down.
  seen.segments[1].normal = {0, -std::cos(0.52), -std::sin(0.52)};
  seen.segments[1].distance_m = 0.3;
  seen.segments[1].middle = {0, 0, 0.3 / std::sin(0.52)};
  DepthImage depth{seen.info, kWidth, kHeight, {}}, flat = depth;
  const auto floor_px = [&](int v) {
    const double down = std::cos(0.52) * (v - camera.cy) / camera.fy + std::sin(0.52);
    return static_cast<float>(std::max(0.0, camera.fx * camera.baseline_m * down / 0.3));
  };
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const auto at = static_cast<std::size_t>(v * kWidth + u);
      const bool can = on_can(u, v, 4);
      if (can) seen.label[at] = 0;
      flat.disparity_px.push_back(floor_px(v));
      depth.disparity_px.push_back(floor_px(can ? 100 : v));
      if (on_can(u, v, 0)) image.rgb[3 * at] = image.rgb[3 * at + 1] = image.rgb[3 * at + 2] = 30;
    }
  }
  FloorEdges edges;
  const auto called_floor = [&](const DepthImage* with) {
    PlaneSegments found = seen;
    EXPECT_TRUE(edges.sharpen(image, found, with));
    int can = 0, beside = 0;
    for (int v = 76; v < 112; ++v) {
      for (int u = 20; u < 50; ++u) {
        const bool floor = found.label[static_cast<std::size_t>(v * kWidth + u)] == 2;
        can += floor && on_can(u, v, 0);
        beside += floor && !on_can(u, v, 1);
      }
    }
    return std::pair(can, beside);
  };
  const int can = 7 * 14, beside = 30 * 36 - 9 * 16;
  EXPECT_EQ(called_floor(nullptr), std::pair(can, beside));
  EXPECT_EQ(called_floor(&flat), std::pair(can, beside));
  EXPECT_EQ(called_floor(&depth), std::pair(0, beside));
}

TEST(FloorEdges, RefusesWhatDoesNotFit) {
  const Image image = picture();
  FloorEdges edges;
  const auto refuses = [&](const Image& seen, PlaneSegments found, FloorEdges& with) {
    const auto before = found.label;
    const bool refused = !with.sharpen(seen, found);
    return refused && found.label == before;
  };
  Image cut = image;
  cut.rgb.pop_back();
  EXPECT_TRUE(refuses(cut, planes(0, false), edges));
  EXPECT_TRUE(refuses({}, planes(0, false), edges));
  EXPECT_TRUE(refuses({}, {}, edges));
  EXPECT_TRUE(refuses({kWidth - 1, kHeight, {}}, planes(0, false), edges));
  PlaneSegments other = planes(0, false);
  const DepthImage small{{}, kWidth, kHeight - 1, {}};
  EXPECT_FALSE(edges.sharpen(image, other, &small));
  PlaneSegments few = planes(0, false);
  few.label.pop_back();
  EXPECT_TRUE(refuses(image, few, edges));
  FloorEdges none({.reach_px = 0}), wide({.reach_px = 100});
  EXPECT_TRUE(refuses(image, planes(0, false), none));
  EXPECT_TRUE(refuses(image, planes(0, false), wide));
}

}  // namespace
}  // namespace kaz::vision
