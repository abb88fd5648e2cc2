// Depth and planes in colours.
// SPDX-License-Identifier: Apache-2.0
#include "tools/drawing/vision_views.h"

#include <algorithm>
#include <cmath>

#include "tools/drawing/figure.h"

namespace kaz::figure {
namespace {

void paint(vision::Image& image, std::size_t pixel, const Color& color, double share) {
  const double to[3] = {color.r, color.g, color.b};
  for (std::size_t c = 0; c < 3; ++c) {
    std::uint8_t& code = image.rgb[3 * pixel + c];
    code = static_cast<std::uint8_t>(std::lround((1 - share) * code + share * 255 * to[c]));
  }
}

}  // namespace

vision::Image depth_picture(const vision::DepthImage& depth) {
  vision::Image image{depth.width, depth.height, {}};
  image.rgb.assign(depth.disparity_px.size() * 3, 0);
  if (depth.disparity_px.empty()) return image;
  const vision::CameraModel& camera = depth.info.camera;
  for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
    if (depth.disparity_px[i] <= 0) continue;
    const double z = camera.fx * camera.baseline_m / static_cast<double>(depth.disparity_px[i]);
    // By the logarithm: stereo's error is a share of the depth.
    const double share = std::log(z / 0.2) / std::log(3.0 / 0.2);
    const double near = 0.78 - 0.52 * std::clamp(share, 0.0, 1.0);
    const auto ramp = [near](double middle) {
      return std::clamp(1.5 - 4 * std::abs(near - middle), 0.0, 1.0);
    };
    paint(image, i, {ramp(0.78), ramp(0.52), ramp(0.26)}, 1);
  }
  return image;
}

vision::Image plane_picture(const vision::Image& left, const vision::PlaneSegments& planes) {
  constexpr Color kOthers[] = {kOrange, kPurple, kBlue, kYellow, kRed};
  vision::Image image = left;
  for (std::size_t i = 0; i < planes.label.size(); ++i) {
    const std::size_t label = planes.label[i];
    if (label == 0) continue;
    paint(image, i, planes.segments[label - 1].floor ? kGreen : kOthers[label % 5], 0.55);
  }
  return image;
}

vision::Image flow_picture(const vision::FlowImage& flow, double longest_px) {
  vision::Image image{flow.width, flow.height, {}};
  image.rgb.assign(flow.flow_px.size() * 3, 60);
  for (std::size_t i = 0; i < flow.flow_px.size(); ++i) {
    const Eigen::Vector2f f = flow.flow_px[i];
    if (std::isnan(f.x())) continue;
    const double strength = std::min(1.0, static_cast<double>(f.norm()) / longest_px);
    const double direction = std::atan2(f.y(), f.x());
    // White at rest; red right, yellow-green down, cyan left, violet up.
    const auto part = [&](double at) {
      return 1 - strength * 0.5 * (1 - std::cos(direction - at));
    };
    paint(image, i, {part(0), part(2.0944), part(-2.0944)}, 1);
  }
  return image;
}

}  // namespace kaz::figure
