// Plane segments from depth by stereo in pictures of the simulated eyes, against the scene.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numbers>

#include "tests/integration/vision/rendered_scene_testing.h"
#include "vision/planes/plane_segments.h"

namespace kaz::sim {
namespace {

TEST(RenderedPlanes, TheFloorIsWhereItIs) {
  vision::DepthFinder depths;
  vision::PlaneSegmentFinder finder;
  vision::DepthImage depth;
  vision::PlaneSegments planes;
  for (const int width : {320, 640}) {
    for (const char* texture : {"wood", "carpet", "checker"}) {
      for (const double tilt : {0.35, 0.7}) {
        const RenderedScene scene(width, texture, tilt);
        const auto renderer = scene.renderer();
        ASSERT_TRUE(depths.find(scene.take(*renderer, 1), scene.info(), depth));
        ASSERT_TRUE(finder.find(depth, planes));
        const vision::PlaneSegment* floor = nullptr;
        for (const vision::PlaneSegment& s : planes.segments) {
          if (s.floor && (floor == nullptr || s.pixels > floor->pixels)) floor = &s;
        }
        ASSERT_NE(floor, nullptr);
        int both = 0, either = 0;
        for (int v = 0; v < depth.height; ++v) {
          for (int u = 0; u < depth.width; ++u) {
            if (!depth.known(u, v)) continue;
            const int label = planes.label[static_cast<std::size_t>(v * depth.width + u)];
            const bool found =
                label > 0 && planes.segments[static_cast<std::size_t>(label - 1)].floor;
            const bool truth = scene.truth(u, v).floor;
            both += found && truth ? 1 : 0;
            either += found || truth ? 1 : 0;
          }
        }
        const Eigen::Vector3d up = scene.info().foot_from_eye.linear().row(2).transpose();
        const double angle =
            std::acos(std::min(1.0, up.dot(floor->normal))) * 180 / std::numbers::pi;
        const double height = 1000 * (floor->distance_m - 0.3);
        const double iou = static_cast<double>(both) / either;
        std::printf(
            "%d px, %-7s, %.2f rad: normal %.2f deg, height %+.1f mm, overlap %.3f, error "
            "%.2f px; %zu segments\n",
            width, texture, tilt, angle, height, iou, floor->error_px, planes.segments.size());
        EXPECT_LT(angle, 2);
        EXPECT_LT(std::abs(height), 5);
        EXPECT_GE(iou, 0.9);
      }
    }
  }
}

}  // namespace
}  // namespace kaz::sim
