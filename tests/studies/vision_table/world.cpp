// Floor, boxes and balls of the tables.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/vision_table/world.h"

#include <algorithm>
#include <cmath>

namespace kaz::vision_table {
namespace {

using Kind = sim::Shape::Kind;

// Out of view, near enough that the shadow map does not grow.
const Eigen::Vector3d kAway{0.3, 0, -0.4};

}  // namespace

World::World(const std::string& floor, const sim::Rgb& ball_color, bool boxes, bool clutter) {
  if (floor == "plain") {
    scene.add(Kind::plane, {6, 6, 0}, {0, 0, 0}, {0.62F, 0.60F, 0.57F});
  } else {
    scene.add_ground(floor);
  }
  if (boxes) {
    const sim::Rgb color{0.5F, 0.7F, 0.6F};
    add_box({0.45, 0.12, 0.04}, {0.08, 0.10, 0.08}, color, "carpet");
    add_box({0.65, -0.20, 0.06}, {0.10, 0.15, 0.12}, color, "carpet");
    add_box({1.60, 0.00, 0.50}, {0.10, 4.00, 1.00}, color, "carpet");
  }
  if (clutter) {
    const sim::Rgb red{0.80F, 0.10F, 0.08F}, orange{0.90F, 0.42F, 0.05F};
    add_box({0.42, -0.16, 0.03}, {0.06, 0.06, 0.06}, red, "");
    add_box({0.70, 0.25, 0.05}, {0.05, 0.12, 0.10}, red, "");
    add_box({0.90, -0.05, 0.04}, {0.10, 0.10, 0.08}, orange, "");
    add_box({0.36, 0.20, 0.01}, {0.09, 0.05, 0.02}, {0.55F, 0.25F, 0.12F}, "wood");
    balls_.push_back({{0.50, -0.02, 0.03}, 0.03});
    scene.add_ball(balls_.back().middle, orange, balls_.back().radius);
  }
  ball_ = static_cast<std::size_t>(scene.add_ball(kAway, ball_color, kBallRadius_m));
  board_ = static_cast<std::size_t>(scene.add(Kind::box, kBoard_m, kAway, {0.45F, 0.45F, 0.45F}));
}

void World::add_box(const Eigen::Vector3d& middle, const Eigen::Vector3d& size,
                    const sim::Rgb& color, const std::string& texture) {
  boxes_.push_back({middle, size});
  scene.add(Kind::box, size, middle, color, texture);
}

void World::put_ball(const Eigen::Vector3d& at) {
  scene.pose.frames[ball_].translation() = at;
}
void World::remove_ball() {
  put_ball(kAway);
}
void World::put_board(const Eigen::Isometry3d& pose) {
  scene.pose.frames[board_] = pose;
}
void World::remove_board() {
  Eigen::Isometry3d away = Eigen::Isometry3d::Identity();
  away.translation() = kAway;
  put_board(away);
}

Hit World::along(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
  Hit best;
  const auto nearer = [&](double distance, bool floor) {
    if (distance > 0 && (best.distance == 0 || distance < best.distance)) best = {distance, floor};
  };
  if (ray.z() < 0) {
    const double distance = -from.z() / ray.z();
    const Eigen::Vector3d at = from + distance * ray;
    if (std::abs(at.x()) < 3 && std::abs(at.y()) < 3) nearer(distance, true);
  }
  for (const Box& b : boxes_) {
    const Eigen::Array3d one = (b.middle - 0.5 * b.size - from).array() / ray.array();
    const Eigen::Array3d two = (b.middle + 0.5 * b.size - from).array() / ray.array();
    const double enter = one.min(two).maxCoeff(), leave = one.max(two).minCoeff();
    if (enter < leave) nearer(enter, false);
  }
  for (const Ball& b : balls_) {
    const Eigen::Vector3d to = b.middle - from;
    const double middle = to.dot(ray) / ray.squaredNorm();
    const double off2 = (to - middle * ray).squaredNorm();
    if (off2 < b.radius * b.radius)
      nearer(middle - std::sqrt((b.radius * b.radius - off2) / ray.squaredNorm()), false);
  }
  return best;
}

}  // namespace kaz::vision_table
