// Curves reduced to what can be seen, and estimates of text.
// SPDX-License-Identifier: Apache-2.0
#include "shared/plot/curve.h"

#include <gtest/gtest.h>

#include "shared/plot/text.h"

namespace kaz::plot {
namespace {

using Line = std::vector<Point>;

constexpr Rectangle kArea{0, 0, 10, 10};

TEST(Curve, OfAColumnOfPixelsFourPointsStay) {
  EXPECT_EQ(thinned(Line{{0.1, 5}, {0.2, 9}, {0.3, 6}, {0.4, 1}, {0.5, 4}, {0.9, 5}, {1, 7}}),
            (Line{{0.1, 5}, {0.2, 9}, {0.4, 1}, {0.9, 5}, {1, 7}}));
  EXPECT_EQ(thinned(Line{{3, 3}, {3, 3}}), (Line{{3, 3}}));
  EXPECT_TRUE(thinned({}).empty());
}

TEST(Curve, IsCutAtTheEdges) {
  using Pieces = std::vector<Line>;
  const Line inside{{1, 1}, {2, 9}, {3, 1}};
  EXPECT_EQ(clipped(inside, kArea), (Pieces{inside}));
  EXPECT_EQ(clipped(Line{{2, 5}, {4, 15}, {6, 5}}, kArea),
            (Pieces{{{2, 5}, {3, 10}}, {{5, 10}, {6, 5}}}));
  EXPECT_EQ(clipped(Line{{-5, 5}, {15, 5}}, kArea), (Pieces{{{0, 5}, {10, 5}}}));
  EXPECT_TRUE(clipped(Line{{-5, 2}, {2, -5}, {20, -5}, {20, 20}}, kArea).empty());
  EXPECT_TRUE(clipped(Line{{1, 1}}, kArea).empty());
  // Along an edge and through a corner of the area.
  EXPECT_EQ(clipped(Line{{0, 0}, {10, 0}}, kArea), (Pieces{{{0, 0}, {10, 0}}}));
  EXPECT_EQ(clipped(Line{{-1, -1}, {11, 11}}, kArea).size(), 1u);
}

TEST(Curve, DotsInOnePlaceAreOneDot) {
  EXPECT_EQ(distinct(Line{{1, 1}, {1.1, 1.1}, {1.5, 1}, {1, 1}, {11, 1}, {5, -1}, {10, 10}}, kArea),
            (Line{{1, 1}, {1.5, 1}, {10, 10}}));
}

TEST(Text, WidthGrowsWithSizeAndCountsCharacters) {
  EXPECT_DOUBLE_EQ(text_width("abc", 20), 2 * text_width("abc", 10));
  EXPECT_DOUBLE_EQ(text_width("⁶", 10), text_width("a", 10));
  EXPECT_GT(text_width("wwww", 10), text_width("iiii", 10));
  EXPECT_GT(text_width("abc", 10, true), text_width("abc", 10));
}

TEST(Text, IsBrokenAtSpaces) {
  const std::string text = "one two  three extraordinarily four";
  const double width = text_width("one two three", 10);
  EXPECT_EQ(wrapped(text, width, 10),
            (std::vector<std::string>{"one two three", "extraordinarily", "four"}));
  EXPECT_EQ(wrapped(text, 1, 10).size(), 5u);
  EXPECT_TRUE(wrapped(" ", 100, 10).empty());
}

}  // namespace
}  // namespace kaz::plot
