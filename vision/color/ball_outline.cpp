// Outlines of balls: hypotheses, fit to edges, evidence.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/ball_outline.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numbers>

#include "vision/color/outline.h"
#include "vision/color/outline_edges.h"
#include "vision/color/outline_hypotheses.h"

namespace kaz::vision {
namespace {

using Directions = std::bitset<kOutlineRays>;

// Returns the directions with an edge on the outline, and measures their longest part.
Directions measure_edges(const Image& image, const BallOutline& outline,
                         OutlineEvidence& evidence) {
  const double tolerance = std::max(1.0, 0.08 * outline.radius_px);
  const RayEdges edges = edges_near(image, outline, std::max(3.0, 0.25 * outline.radius_px));
  Directions on;
  int part = 0, longest = 0;
  // Twice around, for a part that crosses the first direction. A gap costs twice its length.
  for (std::size_t k = 0; k < 2 * kOutlineRays; ++k) {
    const RayEdge& edge = edges[k % kOutlineRays];
    const auto [cosine, sine] = outline_rays()[k % kOutlineRays];
    const bool good =
        edge.strong() && std::abs(edge.radius - outline.radius_at(cosine, sine)) < tolerance;
    part = good ? part + 1 : std::max(0, part - 2);
    longest = std::max(longest, part);
    on[k % kOutlineRays] = good;
  }
  evidence.support = static_cast<double>(on.count()) / kOutlineRays;
  evidence.arc = std::min(1.0, static_cast<double>(longest) / kOutlineRays);
  return on;
}

int brightness(const Image& image, std::size_t pixel) {
  return image.rgb[3 * pixel] + image.rgb[3 * pixel + 1] + image.rgb[3 * pixel + 2];
}

std::size_t index_of(const Image& image, int u, int v) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) +
         static_cast<std::size_t>(u);
}

// Brightness of the region (mean), and its share within the outline.
double measure_region(const Image& image, const Region& region, const BallOutline& outline,
                      OutlineEvidence& evidence) {
  double bright = 0;
  int within = 0;
  for (const Run& run : region.runs) {
    for (int u = run.left; u <= run.right; ++u) {
      bright += brightness(image, index_of(image, u, run.row));
      if (outline.contains(u, run.row, 1.06, 0.7)) ++within;
    }
  }
  evidence.covers = static_cast<double>(within) / region.area;
  return bright / region.area;
}

// Counts the pixels within and around an outline.
class PixelCounts {
 public:
  // `bright`: mean brightness of the region. A brighter pixel without the ball's color is a highlight.
  explicit PixelCounts(double bright) : bright_(bright) {}

  // `visible`: the outline is on an edge in the direction of the pixel, so nothing hides the ball there.
  void add_within(bool colored, int brightness, bool upper, bool visible) {
    if (visible) ++visible_;
    if (visible && colored) ++ball_;
    if (visible && !colored && brightness > bright_) ++light_;
    Half& half = upper ? upper_ : lower_;
    half.brightness += brightness;
    ++half.pixels;
  }
  void add_around(bool colored) {
    ++around_;
    if (colored) ++same_;
  }
  void write(OutlineEvidence& evidence) const {
    // Highlights count at most as much as the pixels of the ball's color.
    evidence.filled = static_cast<double>(ball_ + std::min(ball_, light_)) / std::max(1, visible_);
    evidence.isolated = around_ > 0 ? 1 - static_cast<double>(same_) / around_ : 0;
    const double sum = upper_.brightness + lower_.brightness;
    if (upper_.pixels == 0 || lower_.pixels == 0 || sum <= 0) return;
    const double difference = upper_.brightness / upper_.pixels - lower_.brightness / lower_.pixels;
    evidence.shading = std::clamp(difference * (upper_.pixels + lower_.pixels) / sum, -0.5, 0.5);
  }

 private:
  struct Half {
    double brightness = 0;
    int pixels = 0;
  };
  double bright_;
  int visible_ = 0, ball_ = 0, light_ = 0, around_ = 0, same_ = 0;
  Half upper_, lower_;
};

void measure_colors(const Image& image, const Mask& mask, const Directions& on_edge, double bright,
                    const BallOutline& outline, OutlineEvidence& evidence) {
  PixelCounts counts(bright);
  const auto is_visible = [&](double du, double dv) {
    const double turn = std::atan2(dv, du) / (2 * std::numbers::pi) + 1;
    return on_edge[static_cast<std::size_t>(turn * kOutlineRays + 0.5) % kOutlineRays];
  };
  const double reach = 1.8 * outline.radius_px + 2;
  const auto from = [&](double center) { return static_cast<int>(std::max(0.0, center - reach)); };
  const auto to = [&](double center, int size) {
    return static_cast<int>(std::clamp(center + reach, -1.0, size - 1.0));
  };
  for (int v = from(outline.center_v); v <= to(outline.center_v, image.height); ++v) {
    for (int u = from(outline.center_u); u <= to(outline.center_u, image.width); ++u) {
      const std::size_t pixel = index_of(image, u, v);
      const bool colored = mask.pixels[pixel] != 0;
      if (outline.contains(u, v, 1, -0.5)) {
        counts.add_within(colored, brightness(image, pixel), v < outline.center_v,
                          is_visible(u - outline.center_u, v - outline.center_v));
      } else if (outline.contains(u, v, 1.5, 1) && !outline.contains(u, v, 1.1, 1)) {
        counts.add_around(colored);
      }
    }
  }
  counts.write(evidence);
}

}  // namespace

bool BallOutline::contains(double u, double v, double scale, double margin_px) const {
  const double du = u - center_u, dv = v - center_v, square = du * du + dv * dv;
  if (square < 1e-12) return true;
  // The double angle needs no root: cos 2t = (du^2 - dv^2) / square.
  const double shape = (cos2 * (du * du - dv * dv) + sin2 * 2 * du * dv) / square;
  const double radius = scale * radius_px * (1 + shape) + margin_px;
  return radius > 0 && square < radius * radius;
}

double outline_confidence(const OutlineEvidence& e, double radius_px) {
  if (e.support < 0.3) return 0;
  const double logit = 7 * e.arc + 7.6 * e.filled + 42.3 * e.isolated + 7.9 * e.covers +
                       2 * std::log(radius_px) + 7.7 * e.shading - 69.35;
  return 1 / (1 + std::exp(-logit));
}

std::optional<BallOutline> fit_outline(const Image& image, const Mask& mask, const Region& region) {
  const std::vector<OutlinePoint> points = outline_of(region, image.width, image.height);
  constexpr double kSure = 0.9;  // the other hypotheses would take time and change little
  std::optional<BallOutline> best;
  for (BallOutline outline : outline_hypotheses(region, points)) {
    bool fits = true;
    for (const double share : {0.3, 0.2, 0.12}) {
      const double reach = std::max(share * outline.radius_px, 2.0);
      fits = fits && fit_to_edges(outline, edges_near(image, outline, reach));
    }
    if (!fits) continue;
    const Directions on_edge = measure_edges(image, outline, outline.evidence);
    const double bright = measure_region(image, region, outline, outline.evidence);
    measure_colors(image, mask, on_edge, bright, outline, outline.evidence);
    outline.confidence = outline_confidence(outline.evidence, outline.radius_px);
    if (!best || outline.confidence > best->confidence) best = outline;
    if (best->confidence > kSure) break;
  }
  return best;
}

std::vector<BallOutline> OutlineFinder::find(const Image& image) {
  constexpr std::size_t kCandidates = 48;
  std::vector<BallOutline> all, balls;
  const auto pixels = static_cast<std::size_t>(std::max(image.width, 0)) *
                      static_cast<std::size_t>(std::max(image.height, 0));
  mask_ = {};
  if (pixels == 0 || image.rgb.size() != 3 * pixels) return balls;
  extractor_.extract(image, mask_);
  const std::span<const Region> regions = regions_.find(mask_, options_.min_area);
  for (const Region& region : regions.first(std::min(regions.size(), kCandidates))) {
    const std::optional<BallOutline> outline = fit_outline(image, mask_, region);
    if (outline && outline->confidence >= options_.min_confidence) all.push_back(*outline);
  }
  std::ranges::stable_sort(
      all, [](const BallOutline& a, const BallOutline& b) { return a.confidence > b.confidence; });
  for (const BallOutline& one : all) {
    const bool is_new = std::ranges::none_of(balls, [&](const BallOutline& ball) {
      return std::hypot(one.center_u - ball.center_u, one.center_v - ball.center_v) <
             0.75 * (one.radius_px + ball.radius_px);
    });
    if (is_new) balls.push_back(one);
  }
  return balls;
}

}  // namespace kaz::vision
