// Regions against masks drawn by hand and against a flood fill.
// SPDX-License-Identifier: Apache-2.0
#include "vision/image/regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "vision/image/pictures_testing.h"

namespace kaz::vision {
namespace {

Mask mask_from(const std::vector<std::string>& rows) {
  Mask mask{static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), {}};
  for (const std::string& row : rows) {
    for (const char c : row) mask.pixels.push_back(c == '#' ? 255 : 0);
  }
  return mask;
}

TEST(RegionFinder, CornersJoinAndBoxesFit) {
  RegionFinder finder;
  const auto regions = finder.find(mask_from({"##....#.",  //
                                              "..#...#.",  //
                                              "...#..#.",  //
                                              "........",  //
                                              "#......."}));
  ASSERT_EQ(regions.size(), 3U);
  EXPECT_EQ(regions[0].area, 4);  // joined by corners
  EXPECT_EQ(regions[0].left, 0);
  EXPECT_EQ(regions[0].right, 3);
  EXPECT_EQ(regions[0].top, 0);
  EXPECT_EQ(regions[0].bottom, 2);
  EXPECT_DOUBLE_EQ(regions[0].centroid_x, 1.5);   // (0 + 1 + 2 + 3) / 4
  EXPECT_DOUBLE_EQ(regions[0].centroid_y, 0.75);  // (0 + 0 + 1 + 2) / 4
  EXPECT_EQ(regions[1].area, 3);
  EXPECT_EQ(regions[2].area, 1);
}

TEST(RegionFinder, BranchesThatMeetBelowAreOne) {
  RegionFinder finder;
  const auto regions = finder.find(mask_from({"#.#.#",  //
                                              "#.#.#",  //
                                              "#####"}));
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].area, 11);
  EXPECT_EQ(regions[0].runs.size(), 7U);
}

TEST(RegionFinder, OfEqualAreaTheUpperComesFirst) {
  RegionFinder finder;
  const auto regions = finder.find(mask_from({"....##", "......", "##...."}));
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].top, 0);
}

// Areas of all regions by flood fill, sorted downwards.
std::vector<int> areas_by_flood_fill(Mask mask) {
  std::vector<int> areas;
  for (int start = 0; start < mask.width * mask.height; ++start) {
    std::vector<int> open{start};
    int area = 0;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      if (mask.pixels[static_cast<std::size_t>(at)] == 0) continue;
      mask.pixels[static_cast<std::size_t>(at)] = 0;
      ++area;
      const int x = at % mask.width, y = at / mask.width;
      for (int ny = std::max(0, y - 1); ny <= std::min(mask.height - 1, y + 1); ++ny) {
        for (int nx = std::max(0, x - 1); nx <= std::min(mask.width - 1, x + 1); ++nx) {
          open.push_back(ny * mask.width + nx);
        }
      }
    }
    if (area > 0) areas.push_back(area);
  }
  std::sort(areas.begin(), areas.end(), std::greater<>());
  return areas;
}

TEST(RegionFinder, AgreesWithAFloodFillOnRandomMasks) {
  TestRandom random(2);
  RegionFinder finder;
  for (const double density : {0.02, 0.2, 0.4, 0.6, 0.95, 1.0}) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {53, 37}, {64, 64}}) {
      Mask mask{width, height, {}};
      for (int i = 0; i < width * height; ++i) {
        mask.pixels.push_back(random.unit() < density ? 255 : 0);
      }
      std::vector<int> areas;
      for (const Region& region : finder.find(mask)) {
        areas.push_back(region.area);
        int sum = 0;
        for (const auto& run : region.runs) sum += run.right - run.left + 1;
        ASSERT_EQ(sum, region.area);
      }
      ASSERT_EQ(areas, areas_by_flood_fill(mask)) << density << " " << width << " " << height;
    }
  }
}

TEST(RegionFinder, SmallRegionsAreLeftOut) {
  RegionFinder finder;
  EXPECT_EQ(finder.find(mask_from({"##.#", "##.."}), 2).size(), 1U);
  EXPECT_TRUE(finder.find(mask_from({"##.#", "##.."}), 5).empty());
}

TEST(RegionFinder, EmptyAndDamagedMasksHaveNone) {
  RegionFinder finder;
  EXPECT_TRUE(finder.find(Mask{}).empty());
  EXPECT_TRUE(finder.find(Mask{10, 10, std::vector<std::uint8_t>(7, 255)}).empty());
  EXPECT_TRUE(finder.find(Mask{-1, -1, {255}}).empty());
}

}  // namespace
}  // namespace kaz::vision
