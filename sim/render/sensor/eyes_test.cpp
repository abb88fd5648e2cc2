// What vision makes of rendered pictures: the robot's eyes and its ball finder together.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/render/renderer_kind.h"
#include "sim/render/scenes_testing.h"
#include "vision/color/ball.h"

namespace kaz::sim {
namespace {

vision::FrameInfo info_of(const View& view) {
  vision::FrameInfo info;
  info.camera = view.camera;
  info.camera.baseline_m = kEyeBaseline_m;
  return info;
}

class Grounds : public testing::TestWithParam<const char*> {
 protected:
  Grounds() {
    scene_.add_ground(GetParam());
    scene_.add(Shape::Kind::box, {0.10, 0.14, 0.12}, {0.75, -0.30, 0.06}, {0.25F, 0.45F, 0.70F});
    scene_.add(Shape::Kind::box, {0.08, 0.08, 0.20}, {0.85, 0.35, 0.10}, {0.92F, 0.75F, 0.25F});
    scene_.add(Shape::Kind::cylinder, {0.045, 0.11, 0}, {0.60, 0.42, 0.055}, {0.35F, 0.62F, 0.40F});
    scene_.add_ball({0.5, -0.2, 0.02}, {0.95F, 0.55F, 0.10F});  // orange
    scene_.add_ball({0.4, 0.25, 0.02}, {0.75F, 0.20F, 0.75F});  // magenta
    ball_ = scene_.add_ball({0, 0, -1});                        // outside the view
    renderer_ = std::move(*maker_of(kDefaultRenderer)());
    EXPECT_TRUE(renderer_->set_scene(scene_.scene));
  }

  vision::BallObservation look(const View& view) {
    vision::Image picture;
    EXPECT_TRUE(renderer_->render(scene_.pose, view, picture));
    const vision::Image image{picture.width, picture.height, picture.rgb};
    return detector_.detect(image, info_of(view));
  }

  void put_ball(const Eigen::Vector3d& at) {
    scene_.pose.frames[static_cast<std::size_t>(ball_)].translation() = at;
  }

 private:
  TestScene scene_;
  int ball_ = 0;
  std::unique_ptr<Renderer> renderer_;
  vision::BallFinder detector_{vision::BallOptions{}};
};

TEST_P(Grounds, TheBallIsFoundWhereItIs) {
  const View view = eye_view();
  int seen = 0;
  double squares = 0;
  for (double x = 0.12; x < 0.72; x += 0.083) {
    for (double y = -0.2; y < 0.21; y += 0.094) {
      for (const double z : {0.02, 0.13}) {
        const Eigen::Vector3d at(x, y, z), eye = view.world_from_optical.inverse() * at;
        if (eye.norm() < 0.3 || eye.norm() > 0.8) continue;  // the range of the task
        put_ball(at);
        const vision::BallObservation ball = look(view);
        const Eigen::Vector2d pixel = project(view, at);
        ASSERT_TRUE(ball.found) << at.transpose();
        EXPECT_NEAR(ball.center_u, pixel.x(), 0.35) << at.transpose();
        EXPECT_NEAR(ball.center_v, pixel.y(), 0.35) << at.transpose();
        // At 0.8 m the radius is 4.8 px; a raster without anti-aliasing leaves 0.05 px rms of it
        // open.
        const double error = ball.distance_m / eye.norm() - 1;
        EXPECT_NEAR(error, 0, 0.04) << at.transpose();
        squares += error * error;
        ++seen;
      }
    }
  }
  ASSERT_GT(seen, 50);
  EXPECT_LT(std::sqrt(squares / seen), 0.015);
}

TEST_P(Grounds, NoBallIsSeenWhereNoneIs) {
  for (const double tilt : {0.2, 0.6, 1.0}) {
    const vision::BallObservation ball = look(eye_view(320, tilt));
    EXPECT_FALSE(ball.found) << ball.center_u << " " << ball.center_v;
    EXPECT_FALSE(ball.error);
  }
}

TEST_P(Grounds, TheShadedSideIsPartOfTheBall) {
  put_ball({0.35, 0, 0.02});
  const vision::BallObservation ball = look(eye_view());
  ASSERT_TRUE(ball.found);
  EXPECT_GT(ball.confidence, 0.9);
}

INSTANTIATE_TEST_SUITE_P(Textures, Grounds, testing::Values("", "checker", "wood", "carpet"),
                         [](const auto& texture) {
                           return texture.param[0] == '\0' ? "plain" : texture.param;
                         });

}  // namespace
}  // namespace kaz::sim
