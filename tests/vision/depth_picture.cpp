// The picture of docs/vision.md: what an eye sees, how far it is, and which planes are there.
// SPDX-License-Identifier: Apache-2.0
//
// depth_picture FILE
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/vision/rendered_scene.h"
#include "tools/figure/figure.h"
#include "vision/plane_segments.h"

namespace {

using kaz::figure::Color;
using kaz::vision::Image;

void paint(Image& image, std::size_t pixel, const Color& color, double share) {
  const double to[3] = {color.r, color.g, color.b};
  for (std::size_t c = 0; c < 3; ++c) {
    std::uint8_t& code = image.rgb[3 * pixel + c];
    code = static_cast<std::uint8_t>(std::lround((1 - share) * code + share * 255 * to[c]));
  }
}

// Red is near, blue far, by disparity; black is unknown.
Image false_colors(const kaz::vision::DepthImage& depth) {
  Image image{depth.width, depth.height, {}};
  image.rgb.assign(depth.disparity_px.size() * 3, 0);
  const float most = *std::max_element(depth.disparity_px.begin(), depth.disparity_px.end());
  for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
    if (depth.disparity_px[i] <= 0) continue;
    const double near = std::sqrt(static_cast<double>(depth.disparity_px[i] / most));
    const auto ramp = [near](double middle) {
      return std::clamp(1.5 - 4 * std::abs(near - middle), 0.0, 1.0);
    };
    paint(image, i, {ramp(0.78), ramp(0.52), ramp(0.26)}, 1);
  }
  return image;
}

Image segment_colors(Image image, const kaz::vision::PlaneSegments& planes) {
  constexpr Color kOthers[] = {kaz::figure::kOrange, kaz::figure::kPurple, kaz::figure::kBlue,
                               kaz::figure::kYellow, kaz::figure::kRed};
  for (std::size_t i = 0; i < planes.label.size(); ++i) {
    const std::size_t label = planes.label[i];
    if (label == 0) continue;
    paint(image, i, planes.segments[label - 1].floor ? kaz::figure::kGreen : kOthers[label % 5],
          0.55);
  }
  return image;
}

}  // namespace

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
        {false_colors(depth), "disparity: red near, black unknown"},
        {segment_colors(pair.left, planes), "plane segments: green is the floor"}};
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
