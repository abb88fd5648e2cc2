// Depth and planes in colours.
// SPDX-License-Identifier: Apache-2.0
#include "tools/figure/vision_views.h"

#include <algorithm>
#include <cmath>

#include "tools/figure/figure.h"

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

vision::Image plane_picture(const vision::Image& left, const vision::PlaneSegments& planes,
                            Color color) {
  vision::Image image = left;
  for (std::size_t i = 0; i < planes.label.size(); ++i) {
    if (planes.label[i] != 0) paint(image, i, color, 0.55);
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

vision::Image flow_arrows(const vision::Image& left, const vision::FlowImage& flow, int factor,
                          int spacing_px, double stretch) {
  constexpr double kMin_px = 0.5;
  vision::Image image = enlarge(left, factor);
  // Paler, so that the arrows are what is seen first.
  for (std::uint8_t& code : image.rgb) code = static_cast<std::uint8_t>(128 + code / 2);
  std::vector<std::vector<std::pair<double, double>>> arrows;
  const auto large = [&](const Eigen::Vector2d& p) {
    return std::pair(factor * (p.x() + 0.5) - 0.5, factor * (p.y() + 0.5) - 0.5);
  };
  for (int v = spacing_px / 2; v < flow.height; v += spacing_px) {
    for (int u = spacing_px / 2; u < flow.width; u += spacing_px) {
      if (!flow.known(u, v)) continue;
      const Eigen::Vector2d moved = flow.at(u, v).cast<double>();
      if (moved.norm() < kMin_px) continue;
      const Eigen::Vector2d tip = Eigen::Vector2d(u, v) + moved, along = stretch * moved,
                            tail = tip - along, aside(-along.y(), along.x());
      const Eigen::Vector2d barb = tip - 0.3 * along;
      arrows.push_back({large(tail), large(tip), large(barb + 0.15 * aside), large(tip),
                        large(barb - 0.15 * aside)});
    }
  }
  draw_lines(image, arrows, kBlue, 1.2);
  return image;
}

}  // namespace kaz::figure
