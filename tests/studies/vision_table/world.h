// The world of the tables: a floor, boxes, balls; and where a ray from an eye meets it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/view/scenes_testing.h"

namespace kaz::vision_table {

struct Hit {
  double distance = 0;  // in lengths of the ray; 0: nothing there
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

  // `floor`: wood, carpet, checker or plain. Boxes and a wall with texture; with `clutter` also red
  // and orange boxes and an orange ball. The ball that is looked for has this colour.
  World(const std::string& floor, const sim::Rgb& ball_color, bool boxes, bool clutter);

  // In the world's frame.
  void put_ball(const Eigen::Vector3d& at);
  void remove_ball();
  // A plain grey board of this size, for what hides a ball. Without one it is far below the floor.
  void put_board(const Eigen::Isometry3d& pose);
  void remove_board();

  // The nearest surface along a ray, without ball and board.
  Hit along(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const;

  sim::TestScene scene;

 private:
  void add_box(const Eigen::Vector3d& middle, const Eigen::Vector3d& size, const sim::Rgb& color,
               const std::string& texture);

  std::vector<Box> boxes_;
  std::vector<Ball> balls_;
  std::size_t ball_ = 0, board_ = 0;  // frames
};

inline const Eigen::Vector3d kBoard_m{0.2, 0.2, 0.002};

}  // namespace kaz::vision_table
