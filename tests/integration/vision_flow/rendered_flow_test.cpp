// Flow in pictures of the simulated eyes while the head turns, against the scene.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "shared/base/angle.hpp"
#include "tests/integration/vision_flow/moving_scene_testing.h"
#include "vision/flow/flow.h"

namespace kaz::sim {
namespace {

struct Errors {
  std::vector<double> px;
  int seen = 0;  // pixels that have a true flow
  double at(double p) {
    std::sort(px.begin(), px.end());
    return px.empty() ? NAN
                      : px[static_cast<std::size_t>(p * (static_cast<double>(px.size()) - 1))];
  }
  double within(double limit) const {
    return static_cast<double>(
               std::count_if(px.begin(), px.end(), [=](double e) { return e < limit; })) /
           static_cast<double>(std::max<std::size_t>(1, px.size()));
  }
};

struct Turn {
  int width;
  const char* floor;
  double degrees_s;
};

class RenderedFlow : public ::testing::TestWithParam<Turn> {};

TEST_P(RenderedFlow, EndsAtTheObjectsNewPlace) {
  const auto [width, floor, rate] = GetParam();
  MovingScene scene(width, floor);
  const MovingPoses before{MovingScene::turned(0.1)},
      after{MovingScene::turned(0.1 + rate * kDegree / 30)};
  const auto a = scene.take(before, 1), b = scene.take(after, 2);
  const auto info_a = scene.info(before, 1), info_b = scene.info(after, 2);
  vision::FlowFinder finder;
  vision::FlowImage flow;
  const auto found = finder.find(a.left, info_a, b.left, info_b, flow);
  ASSERT_TRUE(found) << found.error().message;
  Errors dense;
  for (int v = 0; v < flow.height; v += 2) {
    for (int u = 0; u < flow.width; u += 2) {
      const Eigen::Vector2d truth = scene.flow(before, after, u, v);
      if (std::isnan(truth.x())) continue;
      ++dense.seen;
      if (flow.known(u, v)) dense.px.push_back((flow.at(u, v).cast<double>() - truth).norm());
    }
  }
  const double known = static_cast<double>(dense.px.size()) / dense.seen;
  std::printf(
      "%d px, %-7s %2.0f deg/s: dense known %3.0f %%, error 50 %% %.2f, 90 %% %.2f px, within 1 px "
      "%.1f %%\n",
      width, floor, rate, 100 * known, dense.at(0.5), dense.at(0.9), 100 * dense.within(1));
  // Measured on these pictures: half of the textured carpet and more, errors of 0.13 to 0.26 px.
  // Wood is the hard one: its grain runs along one direction, and one sample a pixel flickers.
  const bool wood = std::string(floor) == "wood";
  EXPECT_GE(known, wood ? 0.3 : 0.5);
  EXPECT_LE(dense.at(0.5), wood ? 0.5 : 0.35);
  EXPECT_GE(dense.within(1), wood ? 0.75 : 0.97);
}

INSTANTIATE_TEST_SUITE_P(Turns, RenderedFlow,
                         ::testing::Values(Turn{320, "wood", 10}, Turn{320, "wood", 30},
                                           Turn{320, "wood", 60}, Turn{320, "carpet", 10},
                                           Turn{320, "carpet", 30}, Turn{320, "carpet", 60},
                                           Turn{640, "carpet", 10}, Turn{640, "carpet", 30},
                                           Turn{640, "carpet", 60}),
                         [](const auto& tested) {
                           return std::string(tested.param.floor) +
                                  std::to_string(tested.param.width) + "at" +
                                  std::to_string(static_cast<int>(tested.param.degrees_s));
                         });

}  // namespace
}  // namespace kaz::sim
