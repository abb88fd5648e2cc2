// Test double of Vision: simulates the observations of a ball that moves on a known path.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "host/behavior/vision.h"
#include "host/robot/robot.h"
#include "host/robot/robot_testing.h"

namespace kaz::behavior {

// Returns a camera with 320 x 240 px, a field of view of 80 degrees and a baseline of 4 cm.
vision::CameraModel camera_model();

// Simulates observations at 30 Hz. The simulated images have 320 x 240 px and a field of view of 80 degrees.
// Each observation is computed from the true head pose at the exposure. An observation is available `latency`
// after its exposure. Each observation contains the posture from the robot's history. `board` and `robot`
// must outlive this object.
class TestBall final : public Vision {
 public:
  struct Options {
    Time latency = std::chrono::milliseconds(35);  // 15 ms camera, 20 ms vision
    double noise_px = 0.3;                         // standard deviation on each axis
    double distance_noise = 0.03;                  // standard deviation, relative
    std::uint64_t seed = 1;
  };
  using Path = std::function<Eigen::Vector3d(Time)>;  // m, trunk frame
  TestBall(const host::TestBoard& board, const host::Robot& robot, Path path)
      : TestBall(board, robot, std::move(path), Options{}) {}
  TestBall(const host::TestBoard& board, const host::Robot& robot, Path path,
           const Options& options);

  Result<std::vector<vision::BallObservation>> poll(Time now) override;
  Result<std::vector<FloorPicture>> take_floor() override { return {}; }

  // True angle between the left optical axis and the ball. `t` must not be in the future.
  double error_rad(Time t) const;
  // Share (0 to 1) of the times from `begin` to `end` at which error_rad() is at most `limit_rad`. The step
  // between these times is 1 ms.
  double share_within(double limit_rad, Time begin, Time end) const;

  // False: the image shows no ball.
  std::function<bool(Time)> visible = [](Time) { return true; };
  // If set, poll() returns this error.
  std::optional<Error> failure;
  std::function<bool(Time)> lost = [](Time) { return false; };  // true: no image comes

 private:
  Eigen::Vector3d in_eye(Time t) const;
  vision::BallObservation observe(Time exposure);
  double noise();

  const host::TestBoard& board_;
  const host::Robot& robot_;
  Path path_;
  Options options_;
  std::uint64_t random_;
  std::uint64_t next_ = 0;  // sequence number of the next image
};

}  // namespace kaz::behavior
