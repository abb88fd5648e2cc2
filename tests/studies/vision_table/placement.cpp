// Seeded places: the picture first, then how far the eye looks down so that the ball is above ground.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/vision_table/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kaz::vision_table {
namespace {

double within(Random& random, double from, double to) {
  return from + (to - from) * random.uniform();
}

// Between eye and ball, and along its outline, nothing of the world.
bool in_sight(const World& world, const Eigen::Vector3d& eye, const Eigen::Vector3d& ball) {
  const Eigen::Vector3d to = ball - eye;
  const Eigen::Vector3d x = to.unitOrthogonal(), y = to.normalized().cross(x);
  for (int i = 0; i < 16; ++i) {
    const double turn = 2 * std::numbers::pi * i / 16;
    const Eigen::Vector3d rim =
        1.2 * World::kBallRadius_m * (std::cos(turn) * x + std::sin(turn) * y);
    const Hit hit = world.along(eye, to + rim);
    if (hit.distance > 0 && hit.distance < 1 && !hit.floor) return false;
  }
  return true;
}

// A board's straight edge over the ball: 0.2 to 0.7 of its radius beside the centre.
void hide(Random& random, const Placement& place, World& world) {
  const Eigen::Vector3d at = place.eye.inverse() * place.ball;
  Eigen::Isometry3d board = Eigen::Isometry3d::Identity();
  const double near = 0.8, turn = within(random, 0, 2 * std::numbers::pi);
  // The ball is before the eye: never opposite to the optical axis.
  const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(at);
  board.linear() = Eigen::AngleAxisd(std::atan2(across.norm(), at.z()), across.stableNormalized()) *
                   Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const double beside = near * within(random, 0.2, 0.7) * World::kBallRadius_m;
  board.translation() =
      near * at + board.linear() * Eigen::Vector3d(beside + 0.5 * kBoard_m.x(), 0, 0);
  world.put_board(place.eye * board);
}

}  // namespace

Placement place_ball(Random& random, const vision::CameraModel& camera, double distance_m,
                     Visibility visibility, World& world) {
  world.remove_board();
  Placement place;
  place.distance_m = distance_m;
  // In the corners an ellipse is up to 1.6 times as long as the ball's radius at the middle.
  const double radius = camera.fx * World::kBallRadius_m / distance_m;
  const double margin = 1.7 * radius + 3;
  for (;;) {
    if (visibility == Visibility::cut) {
      // Along an edge: of the ball's middle row or column between a fifth and six tenths is lost.
      const double out = within(random, -0.6, 0.2) * radius;
      const bool sideways = random.chance(0.5), first = random.chance(0.5);
      const double width = camera.width - 1, height = camera.height - 1;
      place.u = sideways ? (first ? -out : width + out) : within(random, margin, width - margin);
      place.v = sideways ? within(random, margin, height - margin) : (first ? -out : height + out);
    } else {
      place.u = within(random, margin, camera.width - 1 - margin);
      place.v = within(random, margin, camera.height - 1 - margin);
    }
    const double tilt = within(random, -0.3, 1.0), height = within(random, 0.25, 0.45);
    const double turn = within(random, -0.3, 0.3);
    place.eye =
        sim::look_at({0, 0, height}, {std::cos(tilt) * std::cos(turn),
                                      std::cos(tilt) * std::sin(turn), height - std::sin(tilt)});
    const Eigen::Vector3d ray((place.u - camera.cx) / camera.fx, (place.v - camera.cy) / camera.fy,
                              1);
    place.ball = place.eye * (distance_m * ray.normalized());
    if (place.ball.z() < World::kBallRadius_m) continue;
    if (in_sight(world, place.eye.translation(), place.ball)) break;
  }
  world.put_ball(place.ball);
  if (visibility == Visibility::hidden) hide(random, place, world);
  return place;
}

bool at_the_ball(const Placement& place, const vision::CameraModel& camera,
                 const vision::BallObservation& ball) {
  const double radius = camera.fx * World::kBallRadius_m / place.distance_m;
  return std::hypot(ball.center_u - place.u, ball.center_v - place.v) < std::max(3.0, 0.5 * radius);
}

}  // namespace kaz::vision_table
