// The picture of docs/explanation/vision.md: what an eye sees, how far it is, and which planes are there.
// SPDX-License-Identifier: Apache-2.0
//
// depth_picture FILE
#include <cstdio>

#include "tests/integration/vision/rendered_scene_testing.h"
#include "tools/drawing/figure.h"
#include "tools/drawing/vision_views.h"
#include "vision/planes/plane_segments.h"

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "usage: depth_picture FILE\n");
    return 2;
  }
  const kaz::sim::RenderedScene scene(640, "wood", 0.55, true);
  const auto renderer = scene.renderer();
  const auto pair = scene.take(*renderer, 1);
  kaz::vision::DepthFinder depths;
  kaz::vision::DepthImage depth;
  kaz::vision::PlaneSegmentFinder finder;
  kaz::vision::PlaneSegments planes;
  auto done = depths.find(pair, scene.info(), depth);
  if (done) done = finder.find(depth, planes);
  if (done) {
    const kaz::figure::Panel panels[] = {
        {pair.left, "left eye, rectified"},
        {kaz::figure::depth_picture(depth), "disparity: red near, black unknown"},
        {kaz::figure::plane_picture(pair.left, planes), "plane segments: green is the floor"}};
    done = kaz::figure::write_png(words[1], kaz::figure::compose(panels, 3, 300));
  }
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().message.c_str());
    return static_cast<int>(done.error().fault);
  }
  for (const auto& s : planes.segments)
    std::printf("plane %d: %d px, %.2f m from the eye, %.2f x %.2f m, error %.2f px%s\n", s.plane,
                s.pixels, s.distance_m, s.length_m, s.width_m, s.error_px,
                s.floor ? ", floor" : "");
  return 0;
}
