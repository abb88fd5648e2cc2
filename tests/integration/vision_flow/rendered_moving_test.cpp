// A ball that rolls, or rests, before eyes that turn and move: what is said to move.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "shared/base/angle.hpp"
#include "tests/integration/vision_flow/moving_scene_testing.h"
#include "vision/depth/depth.h"
#include "vision/flow/independent_motion.h"

namespace kaz::sim {
namespace {

using Eigen::Vector3d;

struct Way {
  const char* name;
  int width;
  const char* floor;
  double pan_deg_s;
  Vector3d eye_m_s, ball_m_s;
  double posture_rad = 0;  // error of the pan and tilt readings, of either sign
};

std::string text(const vision::MovingRegions& moving) {
  std::string all;
  for (const auto& r : moving.regions) {
    char one[120];
    std::snprintf(one, sizeof one, "%d px at %.1f %.1f with %.0f %.0f px/s (%.2f); ", r.pixels,
                  r.center_u, r.center_v, r.velocity_px_s.x(), r.velocity_px_s.y(), r.confidence);
    all += one;
  }
  return all;
}

class RenderedMoving : public ::testing::TestWithParam<Way> {
 protected:
  MovingPoses poses(double t) const {
    const Way& w = GetParam();
    return {MovingScene::turned(0.05 + w.pan_deg_s * kDegree * t, 0.55, w.eye_m_s * t),
            Vector3d(0.45, 0.02, MovingScene::kBallRadius) + w.ball_m_s * t};
  }
  // As the potentiometers say, at exposure `number`.
  vision::FrameInfo info(const MovingScene& scene, double t, std::uint64_t number) const {
    const Way& w = GetParam();
    const double pan = number % 2 == 0 ? w.posture_rad : -w.posture_rad;
    const double tilt = number % 4 < 2 ? w.posture_rad : -w.posture_rad;
    MovingPoses read = poses(t);
    read.eye =
        MovingScene::turned(0.05 + w.pan_deg_s * kDegree * t + pan, 0.55 + tilt, w.eye_m_s * t);
    return scene.info(read, number);
  }
};

TEST_P(RenderedMoving, TheBallAloneMoves) {
  const Way& w = GetParam();
  MovingScene scene(w.width, w.floor);
  vision::FlowFinder flows;
  vision::FlowImage flow;
  vision::DepthFinder depths;
  vision::DepthImage depth;
  vision::IndependentMotionDetector finder;
  vision::MovingRegions moving;
  double worst_off = 0, worst_px_s = 0, worst_m_s = 0;
  for (int i = 0; i < 6; ++i) {
    const MovingPoses before = poses(i / 30.0), after = poses((i + 1) / 30.0);
    const auto number = static_cast<std::uint64_t>(i + 1);
    const auto a = scene.take(before, number), b = scene.take(after, number + 1);
    const auto read = info(scene, i / 30.0, number);
    ASSERT_TRUE(flows.find(a.left, read, b.left, info(scene, (i + 1) / 30.0, number + 1), flow));
    ASSERT_TRUE(depths.find(a, read, depth));
    for (const bool stereo : {true, false}) {
      const auto found = finder.find(flow, a.left, b.left, stereo ? &depth : nullptr, moving);
      ASSERT_TRUE(found) << found.error().message;
      const std::string where = std::string(stereo ? "stereo" : "floor") + ", pair " +
                                std::to_string(i) + ": " + text(moving);
      if (w.ball_m_s.isZero()) {
        EXPECT_TRUE(moving.regions.empty()) << where;
        continue;
      }
      ASSERT_EQ(moving.regions.size(), 1U) << where;
      const vision::MovingRegion& region = moving.regions[0];
      const Eigen::Vector2d centre = scene.pixel(before, before.ball);
      const Eigen::Vector2d own =
          (scene.pixel(after, after.ball) - scene.pixel(after, before.ball)) * 30;
      const double off = (Eigen::Vector2d(region.center_u, region.center_v) - centre).norm();
      const double wrong = (region.velocity_px_s - own).norm() / own.norm();
      worst_off = std::max(worst_off, off);
      worst_px_s = std::max(worst_px_s, wrong);
      // Half of the ball's radius (7.6 px, 15 px): its bright upper side is as grey as the floor.
      EXPECT_LT(off, w.width == 320 ? 4 : 8) << where << centre.transpose();
      // Flow of wood errs by half a pixel in a whole picture, and so does the turn found from it.
      const double limit = w.floor == std::string("wood") ? 0.2 : 0.15;
      EXPECT_LT(wrong, limit) << where << own.transpose();
      EXPECT_EQ(region.velocity_m_s.has_value(), stereo);
      if (!stereo) continue;
      const double wrong_m = (*region.velocity_m_s - w.ball_m_s).norm() / w.ball_m_s.norm();
      worst_m_s = std::max(worst_m_s, wrong_m);
      EXPECT_LT(wrong_m, limit) << where << region.velocity_m_s->transpose();
      // Half a block of the disparity is 7 px: floor in front of the ball or behind it.
      EXPECT_LT((*region.position_m - before.ball).norm(), 0.05) << region.position_m->transpose();
    }
  }
  if (!w.ball_m_s.isZero())
    std::printf("%-8s centre within %.1f px, speed within %.0f %% (px/s), %.0f %% (m/s)\n", w.name,
                worst_off, 100 * worst_px_s, 100 * worst_m_s);
}

const Vector3d kNot = Vector3d::Zero();
INSTANTIATE_TEST_SUITE_P(
    Ways, RenderedMoving,
    ::testing::Values(Way{"still", 320, "carpet", 0, kNot, {0, 0.3, 0}},
                      Way{"turning", 320, "carpet", 30, kNot, {0, -0.3, 0}},
                      Way{"going", 320, "carpet", 0, {0.1, 0, 0}, {0, 0.3, 0}},
                      Way{"fine", 640, "carpet", 30, {0.1, 0, 0}, {0.1, 0.3, 0}},
                      Way{"wood", 320, "wood", 30, kNot, {0, -0.3, 0}},
                      Way{"rests", 320, "carpet", 30, {0.1, 0, 0}, kNot},
                      Way{"restswood", 320, "wood", 30, {0.1, 0, 0}, kNot},
                      Way{"restsfine", 640, "carpet", 60, {0.1, 0, 0}, kNot},
                      // A code of a potentiometer: twice the standard deviation of its noise.
                      Way{"noisy", 320, "carpet", 30, kNot, {0, -0.3, 0}, 0.0033},
                      Way{"restsnoisy", 320, "carpet", 30, {0.1, 0, 0}, kNot, 0.0033}),
    [](const auto& tested) { return std::string(tested.param.name); });

class IndependentMotionErrors : public ::testing::Test {
 protected:
  MovingScene scene{320, "carpet"};
  MovingPoses before{MovingScene::turned(0)}, after{MovingScene::turned(0.01)};
  vision::StereoImages a = scene.take(before, 1), b = scene.take(after, 2);
  vision::FlowImage flow;
  vision::DepthImage depth;
  vision::MovingRegions moving;

  void SetUp() override {
    ASSERT_TRUE(vision::FlowFinder().find(a.left, scene.info(before, 1), b.left,
                                          scene.info(after, 2), flow));
    ASSERT_TRUE(vision::DepthFinder().find(a, scene.info(before, 1), depth));
  }
  std::string complaint(const vision::DepthImage* with = nullptr) {
    const auto found = vision::IndependentMotionDetector().find(flow, a.left, b.left, with, moving);
    return found ? "none" : found.error().message;
  }
};

TEST_F(IndependentMotionErrors, NoRegionsWithoutThePosture) {
  EXPECT_EQ(complaint(), "none");
  flow.after.posture_known = false;
  EXPECT_NE(complaint().find("posture at the later picture is not known"), std::string::npos);
  EXPECT_TRUE(moving.regions.empty());
  flow.before.posture_known = false;
  EXPECT_NE(complaint().find("posture at the earlier picture"), std::string::npos);
}

TEST_F(IndependentMotionErrors, AnotherFootIsNotTakenForMotion) {
  flow.after.foot_from_eye = Eigen::Translation3d(0, 0.2, 0) * flow.after.foot_from_eye;
  EXPECT_NE(complaint().find("the eye jumped"), std::string::npos);
}

TEST_F(IndependentMotionErrors, DepthAndPicturesMustBelongToTheFlow) {
  EXPECT_EQ(complaint(&depth), "none");
  depth.info = scene.info(after, 3);
  EXPECT_NE(complaint(&depth).find("to neither of the flow's two pictures"), std::string::npos);
  depth.width = 100;
  EXPECT_NE(complaint(&depth).find("differ in size"), std::string::npos);
  b.left.rgb.pop_back();
  EXPECT_NE(complaint().find("pictures and flow differ in size"), std::string::npos);
  flow = {};
  EXPECT_NE(complaint().find("flow image is empty"), std::string::npos);
}

// Depth of the later picture is looked up where the flow leads.
TEST_F(IndependentMotionErrors, DepthOfEitherExposureDoes) {
  ASSERT_TRUE(vision::DepthFinder().find(b, scene.info(after, 2), depth));
  EXPECT_EQ(complaint(&depth), "none");
  EXPECT_TRUE(moving.regions.empty());
  const auto stereo =
      std::count(moving.depth.begin(), moving.depth.end(), vision::MovingRegions::Depth::stereo);
  EXPECT_GT(stereo, 1000);
}

}  // namespace
}  // namespace kaz::sim
