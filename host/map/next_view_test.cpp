// Views are chosen where floor is unknown, near the path, and not behind walls.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/next_view.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "host/map/view_testing.h"
#include "shared/base/angle.hpp"

namespace kaz::map {
namespace {

using Eigen::Vector2d;

const double kCandidates[] = {-60 * kDegree, -30 * kDegree, 0, 30 * kDegree, 60 * kDegree};
const Viewpoint kHere{.half_view_rad = 30 * kDegree};

// A map after looks into these directions.
LocalMap after(std::initializer_list<double> looks, const TestYard& yard = {}) {
  LocalMap map = LocalMap::make().value();
  std::uint64_t number = 0;
  for (const double pan : looks) {
    for (int k = 0; k < 3; ++k) {
      const TestView view = yard.seen(test_eye(pan, 0.5), 0.05, ++number);
      EXPECT_TRUE(map.update(view.planes, view.depth, view.depth.info));
    }
  }
  return map;
}

std::vector<double> chosen(const LocalMap& map, std::span<const Vector2d> path = {}) {
  return directions_worth_a_look(map, kHere, kCandidates, path);
}

TEST(NextView, LooksAllAroundAtFirstAndNowhereAfterwards) {
  const auto first = chosen(after({}));
  for (const double side : {-60 * kDegree, 60 * kDegree})
    EXPECT_NE(std::ranges::find(first, side), first.end()) << side / kDegree;
  EXPECT_TRUE(chosen(after({-75 * kDegree, -50 * kDegree, -25 * kDegree, 0, 25 * kDegree,
                            50 * kDegree, 75 * kDegree}))
                  .empty());
}

TEST(NextView, LooksWhereThePathLeadsIntoTheUnknown) {
  const LocalMap ahead = after({-20 * kDegree, 0, 20 * kDegree});
  const Vector2d left[] = {{0.3, 0}, {0.5, 0.9}}, straight[] = {{0, 0}, {0.8, 0}};
  const auto first = chosen(ahead, left);
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(first.front(), 60 * kDegree);
  for (const double one : chosen(ahead, straight)) EXPECT_NE(one, 0);
  // Where all counts alike, both sides are worth it; where the path counts, one.
  EXPECT_GT(directions_worth_a_look(ahead, kHere, kCandidates, {}, 0.1).size(),
            directions_worth_a_look(ahead, kHere, kCandidates, left, 0.1).size());
}

// A wall close to the left hides what is behind it.
TEST(NextView, DoesNotLookBehindWalls) {
  const TestYard wall{{{{0.3, 0.35, 0.1}, {1.6, 0.04, 0.2}}}};
  const LocalMap map = after({0, 30 * kDegree, 60 * kDegree, 80 * kDegree}, wall);
  for (const double one : chosen(map)) EXPECT_LE(one, 0) << one / kDegree;
}

}  // namespace
}  // namespace kaz::map
