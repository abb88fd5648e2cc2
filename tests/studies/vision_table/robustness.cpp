// Ball, depth and floor under each row's conditions.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/studies/vision_table/placement.h"
#include "tests/studies/vision_table/robust_rows.h"
#include "vision/color/color_learning.h"
#include "vision/planes/plane_segments.h"

namespace kaz::vision_table {
namespace {

// From a ball 0.25 m away in the middle of the picture; the marked region reaches beyond it nowhere.
Result<vision::ColorRange> learned(const RobustCase& row, const Eyes& eyes, sim::Renderer& renderer,
                                   World& world) {
  const Eigen::Isometry3d eye = sim::look_at({0, 0, 0.3}, {0.8, 0, -0.1});
  world.put_ball(eye * Eigen::Vector3d(0, 0, 0.25));
  const auto picture = KAZ_TRY(eyes.take_left(renderer, world.scene.pose, eye, 1'000'000));
  const vision::CameraModel& c = eyes.camera();
  const int radius = static_cast<int>(0.65 * c.fx * World::kBallRadius_m / 0.25);
  const auto color = vision::learn_color(
      picture,
      {static_cast<int>(c.cx) - radius, static_cast<int>(c.cy) - radius, 2 * radius, 2 * radius});
  if (!color) return fail(color.error().fault, row.name + ": " + color.error().message);
  return color->range;
}

Result<void> balls(const RobustCase& row, int pictures, const Eyes& eyes, sim::Renderer& renderer,
                   World& world, RobustRow& result) {
  vision::BallOptions options;
  if (row.learn) {
    const auto range = KAZ_TRY(learned(row, eyes, renderer, world));
    options.color = range;
  }
  vision::BallFinder detector(options);
  Random random(11);
  for (int i = 0; i < pictures; ++i) {
    const double distance_m = 0.25 + 0.75 * random.uniform();
    const Placement place = place_ball(random, eyes.camera(), distance_m, Visibility::whole, world);
    const bool there = i % 3 != 2;  // every third picture is without a ball
    if (!there) world.remove_ball();
    const auto left = KAZ_TRY(
        eyes.take_left(renderer, world.scene.pose, place.eye, static_cast<std::uint64_t>(i)));
    const auto ball = detector.detect(left, eyes.info(place.eye));
    if (!there) {
      ++result.without;
      result.false_finds += ball.found ? 1 : 0;
      continue;
    }
    ++result.balls;
    if (!ball.found) continue;
    if (!at_the_ball(place, eyes.camera(), ball)) {
      ++result.wrong;
      continue;
    }
    ++result.found;
    result.center_px.add(std::hypot(ball.center_u - place.u, ball.center_v - place.v));
    result.distance.add(ball.distance_m / distance_m - 1);
  }
  world.remove_ball();
  return {};
}

// Root mean square of the change from pixel to pixel along the row over the block that is matched,
// in codes of the noiseless picture in usual light.
double texture_at(const vision::Image& image, int u, int v) {
  double sum = 0;
  for (int y = v - 7; y <= v + 7; ++y) {
    for (int x = u - 7; x < u + 7; ++x) {
      const std::uint8_t* c = &image.rgb[static_cast<std::size_t>(y * image.width + x) * 3];
      const double change = 0.299 * (c[3] - c[0]) + 0.587 * (c[4] - c[1]) + 0.114 * (c[5] - c[2]);
      sum += change * change;
    }
  }
  return std::sqrt(sum / (15 * 14));
}

// Pixels with texture that both eyes see; every second of every second row.
void score(const World& world, const Eyes& eyes, const Eigen::Isometry3d& eye,
           const vision::Image& ideal, const vision::DepthImage& depth, RobustRow& result) {
  const vision::CameraModel& c = eyes.camera();
  const Eigen::Vector3d right = eye * Eigen::Vector3d(c.baseline_m, 0, 0);
  for (int v = 8; v < depth.height - 8; v += 2) {
    for (int u = 8; u < depth.width - 8; u += 2) {
      const Eigen::Vector3d ray =
          eye.linear() * Eigen::Vector3d((u - c.cx) / c.fx, (v - c.cy) / c.fy, 1);
      const double z = world.along(eye.translation(), ray).distance;
      const double d = z > 0 ? c.fx * c.baseline_m / z : 0;
      if (d <= 0 || u - d < 8 || texture_at(ideal, u, v) < 2) continue;
      const Eigen::Vector3d at = eye.translation() + z * ray;
      if (std::abs(world.along(right, at - right).distance - 1) > 1e-6) continue;
      ++result.textured;
      if (!depth.known(u, v)) continue;
      ++result.known;
      if (std::abs(depth.disparity(u, v) - d) < 0.6) ++result.good;
    }
  }
}

Result<void> depths(const Eyes& eyes, int pictures, sim::Renderer& renderer, World& world,
                    RobustRow& result) {
  vision::DepthFinder finder;
  vision::PlaneSegmentFinder plane_finder;
  vision::DepthImage depth;
  vision::PlaneSegments planes;
  Random random(12);
  for (int i = 0; i < pictures; ++i) {
    const double height = 0.25 + 0.1 * random.uniform(), tilt = 0.35 + 0.4 * random.uniform();
    const double turn = 0.4 * random.uniform() - 0.2;
    const Eigen::Isometry3d eye =
        sim::look_at({0, 0, height}, {std::cos(tilt) * std::cos(turn),
                                      std::cos(tilt) * std::sin(turn), height - std::sin(tilt)});
    const auto pair =
        KAZ_TRY(eyes.take(renderer, world.scene.pose, eye, static_cast<std::uint64_t>(i)));
    const auto ideal = KAZ_TRY(eyes.ideal(renderer, world.scene.pose, eye));
    ++result.floors;
    // Pictures of one colour are an error, as they should be: no floor then.
    if (!finder.find(pair, eyes.info(eye), depth)) continue;
    score(world, eyes, eye, ideal, depth, result);
    if (!plane_finder.find(depth, planes)) continue;
    const vision::PlaneSegment* floor = nullptr;
    for (const vision::PlaneSegment& s : planes.segments) {
      if (s.floor && (floor == nullptr || s.pixels > floor->pixels)) floor = &s;
    }
    if (floor == nullptr) continue;
    ++result.floors_found;
    const Eigen::Vector3d up = eye.linear().row(2).transpose();
    result.normal_deg.add(std::acos(std::min(1.0, up.dot(floor->normal))) * 180 / std::numbers::pi);
    result.height_mm.add(1000 * (floor->distance_m - height));
  }
  return {};
}

}  // namespace

Result<void> measure_robustness(int width, int pictures, const std::string& only, Table& table) {
  for (const RobustCase& row : robust_cases()) {
    if (!only.empty() && row.group != only && row.name != only) continue;
    RobustRow result;
    result.width = width;
    result.group = row.group;
    result.name = row.name;
    World world(row.floor, row.ball, true, row.clutter);
    const Eyes eyes(width, row.conditions);
    auto renderer = KAZ_TRY(renderer_of(table.renderer, world));
    if (auto done = balls(row, pictures, eyes, *renderer, world, result); !done) return done;
    const bool looks_at_depth = row.group.rfind("ball", 0) != 0 && !row.learn;
    if (looks_at_depth) {
      const int pairs = std::max(2, pictures / 11);
      if (auto done = depths(eyes, pairs, *renderer, world, result); !done) return done;
    }
    table.robust.push_back(std::move(result));
  }
  return {};
}

}  // namespace kaz::vision_table
