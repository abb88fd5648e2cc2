// The picture of docs/explanation/vision.md: flow while the head turns, what rest does not explain, the ball.
// SPDX-License-Identifier: Apache-2.0
//
// flow_picture FILE
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/integration/vision_flow/moving_scene_testing.h"
#include "tools/drawing/figure.h"
#include "vision/flow/independent_motion.h"

namespace {

using kaz::vision::Image;

// Direction as hue, length as strength; grey is unknown.
void paint(Image& image, std::size_t pixel, const Eigen::Vector2f& flow, float max_px) {
  std::uint8_t* to = &image.rgb[3 * pixel];
  if (std::isnan(flow.x())) {
    std::fill(to, to + 3, std::uint8_t{110});
    return;
  }
  const double angle = std::atan2(static_cast<double>(flow.y()), static_cast<double>(flow.x()));
  const double share = std::min(1.0, static_cast<double>(flow.norm() / max_px));
  for (int c = 0; c < 3; ++c) {
    const double hue = 0.5 + 0.5 * std::cos(angle - c * 2.0943951);
    to[c] = static_cast<std::uint8_t>(std::lround(255 * (1 - share * (1 - hue))));
  }
}

Image flow_colors(const kaz::vision::FlowImage& flow, float max_px) {
  Image image{flow.width, flow.height, {}};
  image.rgb.resize(flow.flow_px.size() * 3);
  for (std::size_t i = 0; i < flow.flow_px.size(); ++i) paint(image, i, flow.flow_px[i], max_px);
  return image;
}

Image residual_colors(const kaz::vision::MovingRegions& moving, int width, int height,
                      float max_px) {
  constexpr int kCell = kaz::vision::FlowImage::kCell_px;
  Image image{width, height, {}};
  image.rgb.resize(static_cast<std::size_t>(width * height) * 3);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const int x = std::min(u / kCell, moving.cells_across - 1);
      const int y = std::min(v / kCell, moving.cells_down - 1);
      paint(image, static_cast<std::size_t>(v * width + u),
            moving.residual_px[static_cast<std::size_t>(y * moving.cells_across + x)], max_px);
    }
  }
  return image;
}

// Cells of a region stay as they are, all else is darkened; a circle in the middle, and where that
// would be after 0.2 s.
Image region_view(Image image, const kaz::vision::MovingRegions& moving) {
  constexpr int kCell = kaz::vision::FlowImage::kCell_px;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const int x = std::min(u / kCell, moving.cells_across - 1);
      const int y = std::min(v / kCell, moving.cells_down - 1);
      if (moving.label[static_cast<std::size_t>(y * moving.cells_across + x)] != 0) continue;
      std::uint8_t* p = &image.rgb[static_cast<std::size_t>(v * image.width + u) * 3];
      for (int c = 0; c < 3; ++c) p[c] = static_cast<std::uint8_t>(p[c] / 2);
    }
  }
  for (const auto& r : moving.regions) {
    for (int i = 0; i <= 10; ++i)
      kaz::figure::draw_circle(image, r.center_u + 0.02 * i * r.velocity_px_s.x(),
                               r.center_v + 0.02 * i * r.velocity_px_s.y(), i == 10 ? 5 : 1,
                               kaz::figure::kYellow, 2);
    kaz::figure::draw_circle(image, r.center_u, r.center_v, 16, kaz::figure::kYellow, 2);
    if (!r.velocity_m_s) continue;
    char text[40];
    std::snprintf(text, sizeof text, "%.2f m/s", r.velocity_m_s->norm());
    kaz::figure::draw_text(image, r.center_u - 40, r.center_v + 60, text, 22, kaz::figure::kYellow);
  }
  return image;
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "usage: flow_picture FILE\n");
    return 2;
  }
  using kaz::sim::MovingScene;
  constexpr double kTurn_rad = 30 * 3.14159265358979 / 180 / 30;  // 30 degrees/s at 30 Hz
  MovingScene scene(640, "carpet");
  const kaz::sim::MovingPoses before{MovingScene::turned(0), {0.45, -0.05, 0.02}},
      after{MovingScene::turned(kTurn_rad), {0.45, -0.05 + 0.3 / 30, 0.02}};
  const auto a = scene.take(before, 1), b = scene.take(after, 2);
  kaz::vision::FlowImage flow;
  kaz::vision::DepthImage depth;
  kaz::vision::MovingRegions moving;
  auto done = kaz::vision::FlowFinder().find(a.left, scene.info(before, 1), b.left,
                                             scene.info(after, 2), flow);
  if (done) done = kaz::vision::DepthFinder().find(a, scene.info(before, 1), depth);
  if (done)
    done = kaz::vision::IndependentMotionDetector().find(flow, a.left, b.left, &depth, moving);
  if (done) {
    const kaz::figure::Panel panels[] = {
        {flow_colors(flow, 12), "flow, the head turning by 30 degrees/s"},
        {residual_colors(moving, flow.width, flow.height, 8), "without what rest explains"},
        {region_view(a.left, moving), "what moves by itself, and 0.2 s later"}};
    done = kaz::figure::write_png(words[1], kaz::figure::compose(panels, 3, 300));
  }
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().message.c_str());
    return static_cast<int>(done.error().fault);
  }
  for (const auto& r : moving.regions)
    std::printf("moves: %d px at %.0f, %.0f with %.0f, %.0f px/s\n", r.pixels, r.center_u,
                r.center_v, r.velocity_px_s.x(), r.velocity_px_s.y());
  return 0;
}
