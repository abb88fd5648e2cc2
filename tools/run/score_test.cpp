// Score of a run from the pictures' rows, and the moments at which pictures are kept.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/score.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/base/angle.hpp"
#include "tools/run/moments.h"

namespace kaz::tools {
namespace {

using std::chrono::milliseconds;

constexpr Time kStart = milliseconds(2000);

behavior::PictureRow picture(int after_ms, bool found, double error_deg = 0) {
  behavior::PictureRow row;
  row.exposure = kStart + milliseconds(after_ms);
  row.found = found;
  row.error_rad = error_deg * kDegree;
  return row;
}

TEST(Score, CountsFromTheFirstTrackPhase) {
  behavior::Recording recording;
  recording.phase(kStart, "track-ball", "search");
  recording.phase(kStart + milliseconds(1000), "track-ball", "track");
  recording.phase(kStart + milliseconds(3000), "track-ball", "track");
  recording.picture(picture(500, true, 90));  // before it was found: no part of the score
  recording.picture(picture(1000, true, 3));
  recording.picture(picture(1500, true, 4));
  recording.picture(picture(2000, false));
  recording.picture(picture(2500, true, 0));
  const Score made = score(recording, nullptr, kStart);
  EXPECT_EQ(made.measured_by, "pictures");
  ASSERT_TRUE(made.found_s);
  EXPECT_NEAR(*made.found_s, 1, 1e-9);
  ASSERT_EQ(made.time_s.size(), 5u);
  EXPECT_NEAR(made.time_s[0], 0.5, 1e-9);
  EXPECT_NEAR(made.error_deg[2], 4, 1e-9);
  EXPECT_TRUE(std::isnan(made.error_deg[3]));
  EXPECT_NEAR(made.rms_deg.value(), std::sqrt((9.0 + 16.0) / 3), 1e-9);
}

TEST(Score, CountsAPictureWithoutTheBallAsAMiss) {
  behavior::Recording recording;
  recording.phase(kStart, "track-ball", "track");
  recording.picture(picture(100, true, 2.9));
  recording.picture(picture(200, true, 3.1));
  recording.picture(picture(300, false));
  recording.picture(picture(400, true, 1));
  EXPECT_NEAR(score(recording, nullptr, kStart).within_3deg.value(), 0.5, 1e-9);
}

TEST(Score, IsAbsentWhereTheBallWasNeverTracked) {
  behavior::Recording recording;
  recording.phase(kStart, "track-ball", "search");
  recording.picture(picture(100, true, 1));
  const Score made = score(recording, nullptr, kStart);
  EXPECT_FALSE(made.found_s);
  EXPECT_FALSE(made.within_3deg);
  EXPECT_FALSE(made.rms_deg);
  EXPECT_TRUE(made.time_s.empty()) << "a ball that nobody tracks has no tracking error";
}

TEST(Moments, AreFourOfTrackingSpreadOverTheExpectedTime) {
  Moments moments(4.4);
  EXPECT_FALSE(moments.on_phase(0, {}, "search"));
  EXPECT_FALSE(moments.on_cycle(0.5)) << "still searching";
  EXPECT_FALSE(moments.on_phase(1, {}, "track"));
  std::vector<double> taken;
  for (int k = 0; k < 1000; ++k) {
    const double at_s = 1 + 0.01 * k;
    if (moments.on_cycle(at_s)) taken.push_back(at_s);
  }
  ASSERT_EQ(taken.size(), 4u);
  for (std::size_t k = 0; k < taken.size(); ++k)
    EXPECT_NEAR(taken[k], 1.4 + static_cast<double>(k), 0.011);
}

TEST(Moments, OfCatchingAreOneForEachPhase) {
  Moments moments(30);
  EXPECT_FALSE(moments.on_phase(0, behavior::kCatchBall.milestones, "search"));
  EXPECT_FALSE(moments.on_cycle(0.49));
  EXPECT_EQ(moments.on_cycle(0.51), "search");
  EXPECT_FALSE(moments.on_cycle(0.6)) << "once";
  EXPECT_FALSE(moments.on_phase(1, behavior::kCatchBall.milestones, "look"));
  // Shorter than the 0.4 s at which its picture is due: taken at its end.
  EXPECT_EQ(moments.on_phase(1.2, behavior::kCatchBall.milestones, "walk"), "track");
  EXPECT_EQ(moments.on_cycle(6.3), "approach");
  EXPECT_EQ(moments.on_phase(7, behavior::kCatchBall.milestones, "close"), "catch");
  EXPECT_FALSE(moments.on_phase(8, behavior::kCatchBall.milestones, "walk")) << "each phase once";
  EXPECT_FALSE(moments.on_cycle(20));
}

}  // namespace
}  // namespace kaz::tools
