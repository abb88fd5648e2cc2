// An onlooker's view that shows robot and ball, wherever they are.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/outside_view.h"

#include <Eigen/Geometry>

#include "tools/run/snapshots.h"

namespace kaz::tools {

namespace {

constexpr const char* kBall = "ball::";  // the frames of objects are "model::link"

}  // namespace

bool is_subject(const std::string& frame) {
  return frame.find("::") == std::string::npos || frame.starts_with(kBall);
}

Framing framing_of(const sim::Scene& scene, const sim::ScenePose& pose) {
  constexpr double kFar_m = 1.5;
  Eigen::AlignedBox3d robot, balls;
  for (std::size_t i = 1; i < scene.frames.size() && i < pose.frames.size(); ++i) {
    if (!is_subject(scene.frames[i])) continue;
    (scene.frames[i].starts_with(kBall) ? balls : robot).extend(pose.frames[i].translation());
  }
  if (robot.isEmpty()) robot.extend(scene.robot_start.translation());
  const Eigen::AlignedBox3d both = robot.merged(balls);
  const bool near = !balls.isEmpty() && (balls.center() - robot.center()).norm() < kFar_m;
  const Eigen::AlignedBox3d& shown = near ? both : robot;
  return {shown.center(), shown.diagonal().norm()};
}

sim::View outside_view(const sim::Scene& scene, const Framing& framing, int width) {
  constexpr double kCloser = 0.8;  // the extent is a diagonal, and seldom across the picture
  sim::View view = onlooker_view(framing.middle, kCloser * framing.extent_m, width);
  view.light = scene.light;
  return view;
}

}  // namespace kaz::tools
