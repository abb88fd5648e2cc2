// World of the tables with floor, boxes and balls, and the true intersection of a ray with it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/render/scenes_testing.h"

namespace kaz::vision_table {

struct Hit {
  double distance = 0;  // in lengths of the ray; 0: no surface
  bool floor = false;
};

struct World {
  static constexpr double kBallRadius_m = 0.020;

  struct Box {
    Eigen::Vector3d middle, size;
  };
  struct Ball {
    Eigen::Vector3d middle;
    double radius;
  };

  // `floor`: wood, carpet, checker or plain. `ball_color`: of the target ball. `boxes`: adds textured boxes
  // and a wall. `clutter`: adds red, orange and wooden boxes and an orange ball.
  World(const std::string& floor, const sim::Rgb& ball_color, bool boxes, bool clutter);

  // Moves the target ball; world frame.
  void put_ball(const Eigen::Vector3d& at);
  void remove_ball();
  // Moves a plain gray board of size kBoard_m, to hide the ball.
  void put_board(const Eigen::Isometry3d& pose);
  void remove_board();

  // Returns the nearest surface along a ray, except target ball and board.
  Hit along(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const;

  sim::TestScene scene;

 private:
  void add_box(const Eigen::Vector3d& middle, const Eigen::Vector3d& size, const sim::Rgb& color,
               const std::string& texture);

  std::vector<Box> boxes_;
  std::vector<Ball> balls_;
  std::size_t ball_ = 0, board_ = 0;  // indices of frames in the scene
};

inline const Eigen::Vector3d kBoard_m{0.2, 0.2, 0.002};

}  // namespace kaz::vision_table
