// For tests: a ball on a known path, and eyes that see it as the robot's would.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "host/behavior/ball_detector.h"
#include "host/robot/robot.h"
#include "host/robot/robot_testing.h"

namespace kaz::behavior {

// Pictures at 30 Hz, 320 x 240, 80 degrees wide, seen from where the head truly was at the
// exposure. Each is known `latency` after its exposure and stamped with the posture that the
// robot's history has for it.
class TestBall final : public BallDetector {
 public:
  struct Options {
    Time latency = std::chrono::milliseconds(35);  // 15 of the camera and 20 of vision
    double noise_px = 0.3;                         // standard deviation, each axis
    double distance_noise = 0.03;                  // share
    std::uint64_t seed = 1;
  };
  using Path = std::function<Eigen::Vector3d(Time)>;  // m, in the trunk's frame
  TestBall(const host::TestBoard& board, const host::Robot& robot, Path path)
      : TestBall(board, robot, std::move(path), Options{}) {}
  TestBall(const host::TestBoard& board, const host::Robot& robot, Path path,
           const Options& options);

  Result<std::vector<vision::BallObservation>> poll(Time now) override;

  // Angle between the left eye's axis and the ball: the truth at a time not later than now.
  double error_rad(Time t) const;
  // Share of the milliseconds from `begin` to `end` in which that is at most `limit_rad`.
  double share_within(double limit_rad, Time begin, Time end) const;

  std::function<bool(Time)> visible = [](Time) { return true; };
  std::optional<Error> failure;
  std::function<bool(Time)> lost = [](Time) { return false; };  // no images

 private:
  Eigen::Vector3d in_eye(Time t) const;
  vision::BallObservation observe(Time exposure);
  double noise();

  const host::TestBoard& board_;
  const host::Robot& robot_;
  Path path_;
  Options options_;
  std::uint64_t random_;
  std::uint64_t next_ = 0;  // number of the next picture
};

}  // namespace kaz::behavior
