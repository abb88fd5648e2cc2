// From camera to tracker: capture, pipeline, vision.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/vision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/behavior/ball_testing.h"
#include "host/behavior/ball_tracker.h"
#include "host/camera/capture.h"
#include "host/robot/kinematics.h"
#include "host/robot/robot_testing.h"
#include "shared/base/angle.hpp"
#include "vision/pipeline/modules.h"
#include "vision/pipeline/pipeline.h"

namespace kaz::behavior {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
constexpr double kRadius = 0.020;

// Draws a red ball on grey from where the head truly is, at 30 Hz, 15 ms late.
class DrawingCamera final : public vision::Camera {
 public:
  DrawingCamera(const host::TestBoard& board, const Vector3d& ball)
      : board_(board), ball_(ball), next_(board.now()) {}
  const vision::CameraModel& model() const override { return model_; }
  Result<std::optional<vision::StereoPair>> poll() override {
    if (gone) return fail(Fault::environment, "camera gone");
    if (next_ + 15ms > board_.now()) return std::nullopt;
    vision::StereoPair pair;
    pair.info.exposure = next_;
    pair.info.camera = model_;
    std::promise<std::shared_ptr<const vision::StereoImages>> drawn;
    drawn.set_value(draw(next_));
    pair.images = drawn.get_future().share();
    next_ += 33333us;
    return pair;
  }
  bool gone = false;

 private:
  // A pixel is red if its ray meets the sphere.
  std::shared_ptr<const vision::StereoImages> draw(Time t) const {
    const Vector3d ball = host::trunk_from_eye(board_.angles_at(t)).inverse() * ball_;
    auto images = std::make_shared<vision::StereoImages>();
    vision::Image& left = images->left;
    left.width = model_.width;
    left.height = model_.height;
    for (int v = 0; v < left.height; ++v) {
      for (int u = 0; u < left.width; ++u) {
        const Vector3d ray =
            Vector3d((u - model_.cx) / model_.fx, (v - model_.cy) / model_.fy, 1).normalized();
        const bool red = ray.dot(ball) > 0 && ray.cross(ball).norm() < kRadius;
        for (const int value : {red ? 200 : 120, red ? 20 : 120, red ? 20 : 120}) {
          left.rgb.push_back(static_cast<std::uint8_t>(value));
        }
      }
    }
    images->right = left;
    return images;
  }

  const host::TestBoard& board_;
  Vector3d ball_;
  const vision::CameraModel model_ = camera_model();
  Time next_;
};

TEST(PipelineVision, PlacesTheBallWhileTheHeadMoves) {
  host::TestBoard board;
  host::Robot robot = host::connect_to(board);
  ASSERT_TRUE(robot.state());  // pictures from before the first state would have no posture
  const Vector3d place(0.45, 0.12, -0.10);
  DrawingCamera camera(board, place);
  host::Capture capture(camera, robot);
  vision::Pipeline pipeline({vision::Pace::lockstep, 15ms});
  ASSERT_TRUE(pipeline.add(vision::make_color_module({}, 5ms)));
  PipelineVision eyes(capture, pipeline);

  ASSERT_TRUE(robot.enable(host::kAllJoints));
  const host::JointTarget turned[] = {{host::neck_pan, 0.6}, {host::neck_tilt, 0.7}};
  ASSERT_TRUE(robot.set_targets(turned, 1s));  // both at about 40 degrees/s
  BallTracker tracker;
  const host::Gaze expected = host::gaze_at(place);
  int observations = 0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(robot.state());
    ASSERT_TRUE(board.sleep_until(board.now() + 2ms));
    const auto seen = eyes.poll(board.now());
    ASSERT_TRUE(seen) << seen.error().message;
    for (const vision::BallObservation& observation : *seen) {
      ASSERT_TRUE(observation.found);
      EXPECT_GE(board.now() - observation.info.exposure,
                20ms);  // 15 of the camera, 5 of the module
      EXPECT_NEAR(
          observation.distance_m,
          (host::trunk_from_eye(board.angles_at(observation.info.exposure)).translation() - place)
              .norm(),
          0.03);
      ASSERT_TRUE(tracker.observe(observation));
      // Half a millisecond at 40 degrees/s, a code of the potentiometers, a fifth of a pixel,
      // parallax.
      EXPECT_NEAR(tracker.at(observation.info.exposure).pan_rad, expected.pan_rad, 0.5 * kDegree);
      EXPECT_NEAR(tracker.at(observation.info.exposure).tilt_rad, expected.tilt_rad, 0.5 * kDegree);
      ++observations;
    }
  }
  EXPECT_GE(observations, 20);

  camera.gone = true;
  const auto end = eyes.poll(board.now());
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().message, "camera gone");
}

TEST(PipelineVision, SaysThatNothingLooksForTheBall) {
  host::TestBoard board;
  DrawingCamera camera(board, {0.4, 0, 0});
  vision::Pipeline pipeline({vision::Pace::lockstep, 15ms});
  PipelineVision eyes(camera, pipeline);
  const auto seen = eyes.poll(board.now());
  ASSERT_FALSE(seen);
  EXPECT_NE(seen.error().message.find("color"), std::string::npos);
  const auto floor = eyes.take_floor();
  ASSERT_FALSE(floor);
  EXPECT_NE(floor.error().message.find("needs_floor"), std::string::npos);
}

}  // namespace
}  // namespace kaz::behavior
