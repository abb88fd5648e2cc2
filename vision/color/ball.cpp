// Ball detection: colour, regions from the largest, outline, cone.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/ball.h"

#include <algorithm>
#include <cmath>

#include "vision/color/ball_edge.h"
#include "vision/color/cone.h"
#include "vision/color/outline.h"

namespace kaz::vision {

namespace {

// Unit vector in the optical frame through pixel (u, v).
Eigen::Vector3d ray(const CameraModel& camera, double u, double v) {
  return camera.ray(u, v).normalized();
}

// Mean focal length, px: the geometric mean keeps areas.
double focal(const CameraModel& camera) {
  return std::sqrt(camera.fx * camera.fy);
}

std::vector<Eigen::Vector3d> rays_of(const CameraModel& camera,
                                     const std::vector<OutlinePoint>& points) {
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(points.size());
  for (const OutlinePoint& p : points) rays.push_back(ray(camera, p.u, p.v));
  return rays;
}

// Selects crossings whose scan line is within acos(0.45) = 63 degrees of the outline's normal, taken as the
// direction from `center` (px, of the first fit), and refines them to subpixel positions. A scan line
// parallel to the outline hardly constrains its position: rows serve at the left and right of the ball,
// columns at the top and bottom.
std::vector<OutlinePoint> well_crossed(const Image& image, const std::vector<OutlinePoint>& points,
                                       const Eigen::Vector2d& center) {
  std::vector<OutlinePoint> chosen;
  for (const OutlinePoint& p : points) {
    const Eigen::Vector2d outward = Eigen::Vector2d(p.u, p.v) - center;
    const double across = outward.x() * p.step_u + outward.y() * p.step_v;
    if (across > 0.45 * outward.norm()) chosen.push_back(refined(image, p));
  }
  return chosen;
}

// Share of the outline points on the cone, and the sectors around its axis that they cover.
struct Support {
  double share = 0;
  EdgeSectors sectors;
};

Support support_of(const Cone& cone, const std::vector<Eigen::Vector3d>& rays,
                   double tolerance_rad) {
  const SectorFrame frame(cone.axis);
  EdgeSectors sectors;
  std::size_t on = 0;
  for (const Eigen::Vector3d& r : rays) {
    if (std::abs(angle_outside(cone, r)) > tolerance_rad) continue;
    ++on;
    sectors.set(frame.sector(r));
  }
  if (rays.empty()) return {};
  return {static_cast<double>(on) / static_cast<double>(rays.size()), sectors};
}

// Number of pixels within the cone: those whose ray r satisfies n . r >= cos(alpha) |r|. Large balls are
// sampled at every `step`-th pixel in both directions.
double pixels_within(const Cone& cone, const EllipseAxes& axes, const CameraModel& camera) {
  const Eigen::Vector2d middle = camera.pixel(cone.axis);
  // Bounding square around the projected axis. The axis is inside the ellipse but not its middle, so half
  // the side is twice the longer half axis.
  const double reach = 2 * focal(camera) * std::max(axes.across, axes.along) + 1;
  const int step = std::max(1, static_cast<int>(reach / 80));
  const auto bounds = [reach](double center, int size) {
    return std::pair(std::clamp(static_cast<int>(std::max(center - reach, 0.0)), 0, size - 1),
                     static_cast<int>(std::clamp(center + reach, 0.0, size - 1.0)));
  };
  const auto [left, right] = bounds(middle.x(), camera.width);
  const auto [top, bottom] = bounds(middle.y(), camera.height);
  const double cosine = std::cos(cone.half_angle);
  int count = 0;
  const double step_x = 1 / camera.fx, across = cone.axis.x() * step_x;
  for (int y = top; y <= bottom; y += step) {
    const double ray_y = (y - camera.cy) / camera.fy;
    const double row_length2 = ray_y * ray_y + 1;
    const double row_along = ray_y * cone.axis.y() + cone.axis.z() - across * camera.cx;
    for (int x = left; x <= right; x += step) {
      const double ray_x = (x - camera.cx) * step_x, along = row_along + across * x;
      // n . r >= cos(alpha) |r| squared; both sides are positive, as alpha < 90 degrees.
      if (along > 0 && along * along >= cosine * cosine * (ray_x * ray_x + row_length2)) ++count;
    }
  }
  return static_cast<double>(count) * step * step;
}

// Confidence factor for blur, 1 where the distance is observable. The blur beyond the camera's own
// (sigma 0.7 px) is motion smear: smear^2 = sigma^2 - 0.7^2. Smear in one direction changes the measured
// distance by up to 0.6 smear / radius (simulated with 8 px), so by a tenth at a sixth of the radius; above
// that the factor falls with (radius / (6 smear))^4.
double sharpness(double radius_px, double sigma_px) {
  constexpr double kOwn_px = 0.7;
  const double smear = std::sqrt(std::max(0.0, sigma_px * sigma_px - kOwn_px * kOwn_px));
  const double observable = std::min(1.0, radius_px / std::max(6 * smear, 1e-9));
  return observable * observable * observable * observable;
}

// Fits a ball to a region in three stages: cone through the pixel crossings of the outline (cone.h), cone
// through subpixel crossings, fit of radius and blur on the mixed colours along the edge (ball_edge.h).
std::optional<BallObservation> measure(const Image& image, const CameraModel& camera,
                                       const Region& region, const BallOptions& options) {
  const double pixel = 1 / focal(camera);
  const std::vector<OutlinePoint> crossings = outline_of(region, image.width, image.height);
  std::vector<Eigen::Vector3d> rays = rays_of(camera, crossings);
  const std::optional<Cone> coarse = fit_cone(rays, 0.4 * pixel);
  if (!coarse || !(coarse->axis.z() > 0.05)) return std::nullopt;
  Cone cone = *coarse;
  const auto center_of = [&](const Cone& c) { return camera.pixel(c.axis); };
  const std::vector<OutlinePoint> fine = well_crossed(image, crossings, center_of(cone));
  const std::vector<Eigen::Vector3d> fine_rays = rays_of(camera, fine);
  if (const std::optional<Cone> better = fit_cone(fine_rays, 0.2 * pixel)) cone = *better;
  std::optional<EllipseAxes> axes = ellipse_axes(cone);
  if (!axes) return std::nullopt;
  // Tolerance: 0.6 px for the pixel raster, or for large balls a twentieth of the radius.
  const Support support = support_of(cone, rays, std::max(0.6 * pixel, 0.05 * cone.half_angle));
  const double within = pixels_within(cone, *axes, camera);
  // Small balls have few outline pixels: a sector without one counts as seen if both neighbours have one.
  const EdgeSectors& on = support.sectors;
  const EdgeSectors seen =
      on | (((on << 1) | (on >> (kEdgeSectors - 1))) & ((on >> 1) | (on << (kEdgeSectors - 1))));
  // Without a fit (no contrast, or another outline; one of a thousand real balls) `explained` is 0.25.
  double explained = 0.25, sharp = 1;
  if (const std::optional<EdgeFit> better = fit_edge(image, camera, cone, seen)) {
    if (const std::optional<EllipseAxes> its = ellipse_axes(better->cone)) {
      // If two thirds of the edge or less are visible, blur and radius are correlated: the crossings' cone is
      // more accurate.
      if (3 * seen.count() > 2 * kEdgeSectors) {
        cone = better->cone;
        axes = its;
      }
      explained = better->explained;
      sharp = sharpness(focal(camera) * axes->across, better->sigma_px);
    }
  }

  // Distance = R / sin(alpha). Confidence: geometric mean of the share of the outline on the cone, the
  // ratio of the areas of region and cone, and the explained edge; times sharpness and visible circumference.
  BallObservation ball;
  const Eigen::Vector2d center = center_of(cone);
  ball.center_u = center.x();
  ball.center_v = center.y();
  ball.radius_px = focal(camera) * std::sqrt(axes->across * axes->along);
  ball.direction = cone.axis;
  ball.distance_m = options.radius_m / std::sin(cone.half_angle);
  constexpr double kEnoughSectors = 5;  // a third of the circumference
  const double area = region.area;
  const double filled = std::min(area / std::max(within, 1.0), within / area);
  ball.confidence = std::cbrt(support.share * filled * explained) * sharp *
                    std::min(1.0, static_cast<double>(support.sectors.count()) / kEnoughSectors);
  return ball;
}

// Whether the ball's distance by its size is that at which its ray is one radius above the floor: within 30 %
// and 3 cm, as sizes are measured. False where the posture is not known or the ray does not descend.
bool stands_on_floor(const BallObservation& ball, const FrameInfo& info, double radius_m) {
  const double height_m = info.foot_from_eye.translation().z() - radius_m;
  const double descent = -(info.foot_from_eye.linear() * ball.direction).z();
  if (!info.posture_known || height_m <= 0 || descent < 0.1) return false;
  const double distance_m = height_m / descent;
  return std::abs(ball.distance_m - distance_m) <= 0.30 * distance_m + 0.03;
}

std::optional<Error> unfit(const Image& image, const CameraModel& camera) {
  const auto pixels = static_cast<std::size_t>(std::max(image.width, 0)) *
                      static_cast<std::size_t>(std::max(image.height, 0));
  if (pixels == 0 || image.rgb.size() != 3 * pixels) {
    return Error{Fault::environment, "a picture of " + std::to_string(image.width) + " x " +
                                         std::to_string(image.height) + " pixels with " +
                                         std::to_string(image.rgb.size()) +
                                         " bytes is not valid: check the camera or the file"};
  }
  if (camera.width != image.width || camera.height != image.height) {
    return Error{Fault::usage, "a picture of " + std::to_string(image.width) + " x " +
                                   std::to_string(image.height) +
                                   " does not match its camera model of " +
                                   std::to_string(camera.width) + " x " +
                                   std::to_string(camera.height) + ": check the calibration"};
  }
  if (!(camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx + camera.fy)) ||
      !std::isfinite(camera.cx + camera.cy)) {
    return Error{Fault::usage,
                 "the camera model has no positive focal length: check the calibration"};
  }
  return std::nullopt;
}

}  // namespace

BallObservation BallFinder::detect(const Image& image, const FrameInfo& info) {
  BallObservation best;
  best.info = info;
  best.error = unfit(image, info.camera);
  if (best.error) {
    mask_ = {};
    return best;
  }
  extractor_.extract(image, mask_);
  // Other objects of that colour may be larger than the ball but are less round, or as round but not where
  // their size says, if they are on the floor: of those that stand there, else of all, the highest
  // confidence wins.
  constexpr std::size_t kCandidates = 4, kStanding = 8;
  const std::span<const Region> regions = regions_.find(mask_, options_.min_area);
  const std::size_t count = std::min(regions.size(), info.posture_known ? kStanding : kCandidates);
  bool best_stands = false;
  for (std::size_t i = 0; i < count; ++i) {
    std::optional<BallObservation> ball = measure(image, info.camera, regions[i], options_);
    if (!ball || ball->confidence < options_.min_confidence) continue;
    const bool stands = stands_on_floor(*ball, info, options_.radius_m);
    if (!stands && (best_stands || i >= kCandidates)) continue;
    if (stands == best_stands && ball->confidence < best.confidence) continue;
    best = std::move(*ball);
    best.info = info;
    best.found = true;
    best_stands = stands;
  }
  return best;
}

}  // namespace kaz::vision
