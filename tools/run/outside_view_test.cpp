// The onlooker sees robot and ball.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/outside_view.h"

#include <gtest/gtest.h>

#include "sim/render/scenes_testing.h"

namespace kaz::tools {
namespace {

// Trunk and head of a robot that stands at `robot`, and a ball.
struct StageOfBall {
  sim::Scene scene;
  sim::ScenePose pose;
  StageOfBall(const Eigen::Vector3d& robot, const Eigen::Vector3d& ball) {
    scene.frames = {"world", "trunk", "head", "wall::link", "ball::link"};
    for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(robot),
                                      Eigen::Vector3d(robot + Eigen::Vector3d(0, 0, 0.3)),
                                      Eigen::Vector3d(9, 9, 9), Eigen::Vector3d(ball)}) {
      pose.frames.emplace_back(Eigen::Translation3d(at));
    }
  }
};

TEST(OutsideView, ShowsRobotAndBallWhereverTheyAre) {
  for (const Eigen::Vector3d& robot : {Eigen::Vector3d(0, 0, 0.1), {-2, 3, 0.1}, {5, 0.5, 0.1}}) {
    for (const Eigen::Vector3d& away : {Eigen::Vector3d(0.1, 0, -0.08),
                                        {0.6, 0.5, -0.08},
                                        {-0.9, 0.3, -0.08},
                                        {0.2, -1.2, -0.08}}) {
      const StageOfBall stage(robot, robot + away);
      const sim::View view = outside_view(stage.scene, framing_of(stage.scene, stage.pose), 640);
      for (const std::size_t frame : {1u, 2u, 4u}) {
        const Eigen::Vector2d at = sim::project(view, stage.pose.frames[frame].translation());
        EXPECT_TRUE(at.x() > 0 && at.x() < 639 && at.y() > 0 && at.y() < 479)
            << robot.transpose() << ", " << away.transpose() << ": " << at.transpose();
      }
    }
  }
}

TEST(OutsideView, StaysWithTheRobotWhereTheBallIsFar) {
  const StageOfBall far({0, 0, 0.1}, {4, 0, 0.02});
  const Framing framing = framing_of(far.scene, far.pose);
  EXPECT_NEAR(framing.extent_m, 0.3, 1e-12);
  EXPECT_TRUE(framing.middle.isApprox(Eigen::Vector3d(0, 0, 0.25)));
}

TEST(OutsideView, HasAPlaceWithoutARobot) {
  sim::Scene scene;
  scene.frames = {"world"};
  scene.robot_start.translation() = Eigen::Vector3d(1, 2, 0);
  const Framing framing = framing_of(scene, {{Eigen::Isometry3d::Identity()}});
  EXPECT_EQ(framing.extent_m, 0);
  EXPECT_EQ(framing.middle, Eigen::Vector3d(1, 2, 0));
}

}  // namespace
}  // namespace kaz::tools
