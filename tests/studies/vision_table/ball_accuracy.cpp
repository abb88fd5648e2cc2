// How well the ball is found: many places in the picture at each distance.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/studies/vision_table/placement.h"

namespace kaz::vision_table {

Result<void> measure_accuracy(int width, Visibility visibility, int pictures, Table& table) {
  World world("wood", sim::kRedBall, false, false);
  const Eyes eyes(width, {});
  auto renderer = KAZ_TRY(renderer_of(table.renderer, world));
  vision::BallFinder detector({});
  std::uint64_t number = 0;
  for (const double distance_m : kDistances_m) {
    AccuracyRow row;
    row.width = width;
    row.visibility = visibility;
    row.distance_m = distance_m;
    row.pictures = pictures;
    Random random(100 * static_cast<std::uint64_t>(width) + static_cast<std::uint64_t>(visibility));
    for (int i = 0; i < pictures; ++i) {
      const Placement place = place_ball(random, eyes.camera(), distance_m, visibility, world);
      auto left = KAZ_TRY(eyes.take_left(*renderer, world.scene.pose, place.eye, ++number));
      const auto ball = detector.detect(left, eyes.info(place.eye));
      if (!ball.found) continue;
      if (!at_the_ball(place, eyes.camera(), ball)) {
        ++row.wrong;
        continue;
      }
      ++row.found;
      row.center_px.add(std::hypot(ball.center_u - place.u, ball.center_v - place.v));
      row.distance.add(ball.distance_m / distance_m - 1);
    }
    table.accuracy.push_back(row);
  }
  return {};
}

}  // namespace kaz::vision_table
