// Capture stamps pictures with the posture of their exposure, not of their arrival.
// SPDX-License-Identifier: Apache-2.0
#include "host/camera/capture.h"

#include <gtest/gtest.h>

#include "host/robot/kinematics.h"
#include "host/robot/robot_testing.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;

// Gives what the test puts into it.
class HandFedCamera final : public vision::Camera {
 public:
  const vision::CameraModel& model() const override { return model_; }
  Result<std::optional<vision::StereoPair>> poll() override {
    if (waiting.empty()) {
      if (gone) return fail(Fault::environment, "camera gone");
      return std::nullopt;
    }
    vision::StereoPair pair = waiting.front();
    waiting.pop_front();
    return pair;
  }
  void feed(Time exposure) {
    vision::StereoPair pair;
    pair.info.exposure = exposure;
    waiting.push_back(pair);
  }
  std::deque<vision::StereoPair> waiting;
  bool gone = false;

 private:
  vision::CameraModel model_;
};

struct CaptureTest : ::testing::Test {
  TestBoard board;
  Robot robot = connect_to(board);
  HandFedCamera camera;
  Capture capture{camera, robot};

  void states(int count) {
    for (int i = 0; i < count; ++i) {
      ASSERT_TRUE(board.sleep_until(board.now() + 5ms));
      ASSERT_TRUE(robot.state());
    }
  }
};

TEST_F(CaptureTest, StampsThePostureOfTheExposure) {
  ASSERT_TRUE(robot.enable(kAllJoints));
  const JointTarget target{neck_pan, 1.0};
  ASSERT_TRUE(robot.set_targets({&target, 1}, 1s));
  states(10);
  const Time exposure = board.now() - 3ms;
  states(20);
  camera.feed(exposure);
  const auto pair = capture.poll();
  ASSERT_TRUE(pair && *pair);
  const vision::FrameInfo& info = (*pair)->info;
  ASSERT_TRUE(info.posture_known);
  ASSERT_EQ(info.joint_rad.size(), static_cast<std::size_t>(KZ_JOINTS));
  EXPECT_NEAR(info.joint_rad[neck_pan], board.angles_at(exposure)[neck_pan], 0.0042);
  EXPECT_GT(board.angles_at(board.now())[neck_pan], info.joint_rad[neck_pan] + 0.1);
  JointAngles angle;
  std::copy(info.joint_rad.begin(), info.joint_rad.end(), angle.begin());
  EXPECT_TRUE(info.foot_from_eye.isApprox(foot_from_eye(angle)));
}

TEST_F(CaptureTest, WaitsForANewerState) {
  states(2);
  const Time exposure = board.now() + 1ms;
  camera.feed(exposure);
  ASSERT_TRUE(board.sleep_until(exposure + 10ms));
  auto pair = capture.poll();
  ASSERT_TRUE(pair);
  EXPECT_FALSE(*pair);
  states(1);
  pair = capture.poll();
  ASSERT_TRUE(pair && *pair);
  EXPECT_TRUE((*pair)->info.posture_known);
}

TEST_F(CaptureTest, GoesOnWithoutAPostureWhenNoneComes) {
  camera.feed(board.now());
  EXPECT_FALSE(*capture.poll());
  ASSERT_TRUE(board.sleep_until(board.now() + Capture::kPatience));
  const auto pair = capture.poll();
  ASSERT_TRUE(pair && *pair);
  EXPECT_FALSE((*pair)->info.posture_known);

  // Older than everything remembered: nothing to wait for.
  states(2);
  camera.feed(board.now() - 1s);
  const auto old = capture.poll();
  ASSERT_TRUE(old && *old);
  EXPECT_FALSE((*old)->info.posture_known);
}

TEST_F(CaptureTest, PassesTheCamerasErrorOn) {
  states(3);
  camera.feed(board.now() - 10ms);
  camera.gone = true;
  EXPECT_TRUE(capture.poll());
  const auto end = capture.poll();
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().message, "camera gone");
}

}  // namespace
}  // namespace kaz::host
