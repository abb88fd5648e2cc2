// Coverage of the pixels along the edge, and the blurred cone fitted to it.
// SPDX-License-Identifier: Apache-2.0
#include "vision/color/ball_edge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

namespace kaz::vision {
namespace {

// Distances from the edge, px, negative inside. The blur of lens and rectification is within +-kReach; the
// colours of ball and background are sampled further in and out.
constexpr double kReach = 2.5, kInnerFrom = -4.5, kInnerTo = -1.6, kOuterFrom = 2.2, kOuterTo = 4.2;
constexpr double kMinContrast = 20;  // of 255; below, noise dominates
constexpr std::size_t kMinPixels = 12;

struct Pixel {
  Eigen::Vector3d ray, color;  // ray: z = 1
  double outside_px;           // signed distance from the edge, negative inside
  double per_px;               // change of the angle to the axis per pixel outwards, rad
  std::size_t sector;
  double share;  // coverage by the ball
};

// Signed distance of rays (z = 1) from a cone's surface, px: (angle to the axis - half angle) over the
// gradient of that angle in the image.
class ConeEdge {
 public:
  ConeEdge(const Cone& cone, const CameraModel& camera)
      : axis_(cone.axis),
        half_angle_(cone.half_angle),
        sine_(std::sin(cone.half_angle)),
        cosine_(std::cos(cone.half_angle)),
        inverse_fx_(1 / camera.fx),
        inverse_fy_(1 / camera.fy),
        // Lower bound: on the axis the gradient vanishes.
        min_per_px_(0.2 / std::max(camera.fx, camera.fy)) {}

  // `along`: axis . ray; `length`: |ray|. `per_px`: gradient of the angle, rad/px.
  // cos(angle) = along / length, so d(angle)/dx = -(axis - along / length^2 ray).x / (length sin(angle)),
  // and x changes by 1 / fx per pixel; y alike.
  double outside(const Eigen::Vector3d& ray, double along, double length, double& per_px) const {
    const double inverse = 1 / length, cosine = std::clamp(along * inverse, -1.0, 1.0);
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 1e-12));
    const double share = along * inverse * inverse, scale = inverse / sine;
    const double slope_x = (axis_.x() - share * ray.x()) * scale * inverse_fx_;
    const double slope_y = (axis_.y() - share * ray.y()) * scale * inverse_fy_;
    per_px = std::max(std::sqrt(slope_x * slope_x + slope_y * slope_y), min_per_px_);
    return turn(sine, cosine) / per_px;
  }

 private:
  // angle - half angle = asin(sin(angle - half angle)), by five terms of the Taylor series of asin near the
  // edge, accurate to 1e-13 (the coefficients are 1/6, 3/40, 15/336, 105/3456); else acos(cosine) - half
  // angle.
  double turn(double sine, double cosine) const {
    const double x = sine * cosine_ - cosine * sine_, xx = x * x;
    if (xx > 2.5e-3 || cosine * cosine_ + sine * sine_ < 0) return std::acos(cosine) - half_angle_;
    return x * (1 + xx * (1.0 / 6 + xx * (3.0 / 40 + xx * (15.0 / 336 + xx * (105.0 / 3456)))));
  }

  Eigen::Vector3d axis_;
  double half_angle_, sine_, cosine_, inverse_fx_, inverse_fy_, min_per_px_;
};

std::vector<Pixel> pixels_beside(const Image& image, const CameraModel& camera, const Cone& cone) {
  std::vector<Pixel> pixels;
  const std::optional<EllipseAxes> axes = ellipse_axes(cone);
  if (!axes) return pixels;
  const Eigen::Vector2d middle = camera.pixel(cone.axis);
  const double focal = std::max(camera.fx, camera.fy);
  const double reach = 1.5 * focal * std::max(axes->across, axes->along) + kOuterTo + 1;
  const auto from = [&](double center) {
    return static_cast<int>(std::clamp(center - reach, 0.0, 1e6));
  };
  const auto to = [&](double center, int size) {
    return static_cast<int>(std::clamp(center + reach, -1.0, size - 1.0));
  };
  const SectorFrame frame(cone.axis);
  const ConeEdge edge(cone, camera);
  // Large balls are subsampled by rows and columns, to 250 to 800 pixels.
  const double radius = focal * std::sqrt(axes->across * axes->along);
  const int step = std::max(1, static_cast<int>(std::sqrt(radius / 8) + 0.5));
  pixels.reserve(800);
  // Bounds of the cosine beyond which a ray is not near the edge: rejects most pixels early.
  const double margin = 6 / std::min(camera.fx, camera.fy);
  const double max_cosine = std::cos(std::max(cone.half_angle - margin, 0.0));
  const double min_cosine = std::cos(std::min(cone.half_angle + margin, std::numbers::pi));
  for (int y = from(middle.y()); y <= to(middle.y(), image.height); y += step) {
    for (int x = from(middle.x()); x <= to(middle.x(), image.width); x += step) {
      const Eigen::Vector3d ray = camera.ray(x, y);
      const double along = cone.axis.dot(ray), length = ray.norm();
      if (along > max_cosine * length || along < min_cosine * length) continue;
      double per_px = 0;
      const double d = edge.outside(ray, along, length, per_px);
      if (d < kInnerFrom || d > kOuterTo) continue;
      const std::uint8_t* c =
          &image.rgb[(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                      static_cast<std::size_t>(x)) *
                     3];
      pixels.push_back(
          {ray, {1.0 * c[0], 1.0 * c[1], 1.0 * c[2]}, d, per_px, frame.sector(ray), 0});
    }
  }
  return pixels;
}

struct Sum {
  Eigen::Vector3d color = Eigen::Vector3d::Zero();
  double weight = 0;
  void add(const Eigen::Vector3d& c, double w) {
    color += w * c;
    weight += w;
  }
  void add(const Sum& other) {
    color += other.color;
    weight += other.weight;
  }
  Eigen::Vector3d mean() const { return color / weight; }
};

// Pixels along the edge with their coverage s = 1 - n . (c - b) / n . (g - b) (ball_edge.h; n . b = 0, or the
// fallback n = g - b); b is the mean colour inside, of the sector and its neighbours, g the mean colour
// outside in the sector. Sectors without contrast are skipped.
std::vector<Pixel> with_shares(const std::vector<Pixel>& pixels, const EdgeSectors& seen) {
  std::array<Sum, kEdgeSectors> inner, outer;
  Sum core;
  double deepest = 0;
  for (const Pixel& p : pixels) deepest = std::min(deepest, p.outside_px);
  for (const Pixel& p : pixels) {
    if (!seen[p.sector]) continue;
    if (p.outside_px < kInnerTo) inner[p.sector].add(p.color, 1);
    if (p.outside_px < std::max(kInnerTo, 0.6 * deepest)) core.add(p.color, 1);
    if (p.outside_px > kOuterFrom) outer[p.sector].add(p.color, 1);
  }
  std::vector<Pixel> edge;
  std::array<Eigen::Vector3d, kEdgeSectors> across, ball;
  std::array<double, kEdgeSectors> contrast{};
  for (std::size_t s = 0; s < kEdgeSectors; ++s) {
    if (!seen[s] || outer[s].weight < 1 || core.weight < 1) continue;
    Sum near = inner[s];
    near.add(inner[(s + 1) % kEdgeSectors]);
    near.add(inner[(s + kEdgeSectors - 1) % kEdgeSectors]);
    const Eigen::Vector3d b = near.weight < 3 ? core.mean() : near.mean(), g = outer[s].mean();
    Eigen::Vector3d n = g - b * (g.dot(b) / std::max(b.squaredNorm(), 1.0));
    if (n.norm() < 0.3 * (g - b).norm()) n = g - b;
    if (!(n.norm() > kMinContrast)) continue;
    ball[s] = b;
    across[s] = n;
    contrast[s] = n.dot(g - b);
  }
  for (const Pixel& p : pixels) {
    if (!(contrast[p.sector] > 0) || std::abs(p.outside_px) > kReach) continue;
    edge.push_back(p);
    const double g = across[p.sector].dot(p.color - ball[p.sector]) / contrast[p.sector];
    edge.back().share = std::clamp(1 - g, -0.3, 1.3);
  }
  return edge;
}

// The standard normal distribution and density, from a table with linear interpolation, error below 3e-5.
struct Normal {
  double below, density;
};
Normal normal_at(double q) {
  constexpr int kPerUnit = 32, kEnd = 6, kCount = 2 * kEnd * kPerUnit + 1;
  static const std::array<Normal, kCount> table = [] {
    std::array<Normal, kCount> t{};
    for (int i = 0; i < kCount; ++i) {
      const double x = static_cast<double>(i) / kPerUnit - kEnd;
      t[static_cast<std::size_t>(i)] = {0.5 * std::erfc(-x / std::numbers::sqrt2),
                                        std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi)};
    }
    return t;
  }();
  const double at = std::clamp((q + kEnd) * kPerUnit, 0.0, kCount - 1.001);
  const auto i = static_cast<std::size_t>(at);
  const double f = at - static_cast<double>(i);
  return {table[i].below + f * (table[i + 1].below - table[i].below),
          table[i].density + f * (table[i + 1].density - table[i].density)};
}

// The blurred edge near a cone, linearised: the distance of a pixel from the edge is linear in the rotation
// of the axis and in the half angle. Parameters: rotation components along y_ and x_, change of the half
// angle (rad), sigma (px). Model: s = Phi(q), q = (inside + slope . turn) / sigma.
class BlurredEdge {
 public:
  BlurredEdge(const std::vector<Pixel>& pixels, const Cone& cone)
      : cone_(cone), x_(cone.axis.unitOrthogonal()), y_(cone.axis.cross(x_)) {
    pixels_.reserve(pixels.size());
    for (const Pixel& p : pixels) {
      const Eigen::Vector2d aside(x_.dot(p.ray), y_.dot(p.ray));
      const double scale = 1 / (std::max(aside.norm(), 1e-12) * p.per_px);
      pixels_.push_back(
          {{aside.x() * scale, aside.y() * scale, 1 / p.per_px}, -p.outside_px, p.share});
    }
  }

  // Gauss-Newton with Huber weights on axis, half angle and sigma. False if the normal equations are
  // singular or the result is implausible.
  bool fit(const CameraModel& camera, double start_sigma_px) {
    // Prior of sigma: N(kSigma, kSpread^2), px, with the weight of four pixels of noise kNoise.
    constexpr double kSigma = 0.7, kSpread = 0.3, kNoise = 0.1;
    sigma_px_ = start_sigma_px;
    for (int iteration = 0; iteration < 10; ++iteration) {
      const double prior = 4 * kNoise * kNoise / (kSpread * kSpread);
      const double inverse_sigma = 1 / sigma_px_;
      // Normal equations sum w g g^T step = sum w g r: upper triangle row by row, and right side.
      double n00 = 0, n01 = 0, n02 = 0, n03 = 0, n11 = 0, n12 = 0, n13 = 0, n22 = 0, n23 = 0;
      double n33 = prior, r0 = 0, r1 = 0, r2 = 0, r3 = prior * (kSigma - sigma_px_);
      for (const Row& row : pixels_) {
        const double q = (row.inside_px + row.slope.dot(turn_)) * inverse_sigma;
        const Normal n = normal_at(q);
        const double residual = row.share - n.below;
        // Huber's weight with threshold 2 kNoise: floor texture and highlights are outliers.
        const double weight =
            std::abs(residual) > 2 * kNoise ? 2 * kNoise / std::abs(residual) : 1.0;
        // Gradient of Phi(q): phi(q) / sigma slope for rotation and half angle, -phi(q) q / sigma for sigma.
        const double gain = n.density * inverse_sigma;
        const double g0 = gain * row.slope.x(), g1 = gain * row.slope.y(),
                     g2 = gain * row.slope.z(), g3 = -gain * q;
        const double w0 = weight * g0, w1 = weight * g1, w2 = weight * g2, w3 = weight * g3;
        n00 += w0 * g0, n01 += w0 * g1, n02 += w0 * g2, n03 += w0 * g3;
        n11 += w1 * g1, n12 += w1 * g2, n13 += w1 * g3;
        n22 += w2 * g2, n23 += w2 * g3, n33 += w3 * g3;
        r0 += w0 * residual, r1 += w1 * residual, r2 += w2 * residual, r3 += w3 * residual;
      }
      Eigen::Matrix4d normal;
      normal << n00, n01, n02, n03, n01, n11, n12, n13, n02, n12, n22, n23, n03, n13, n23, n33;
      const Eigen::Vector4d right(r0, r1, r2, r3);
      const Eigen::LDLT<Eigen::Matrix4d> solver(normal);
      if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-14)) return false;
      const Eigen::Vector4d step = solver.solve(right);
      if (!step.allFinite()) return false;
      turn_ += step.head<3>();
      sigma_px_ = std::clamp(sigma_px_ + step[3], 0.3, 2.0);
      if (step.head<3>().norm() * camera.fx < 5e-3) break;
    }
    const double half_angle = cone_.half_angle + turn_.z();
    return half_angle > 1e-4 && half_angle < 1.5 && turn_.head<2>().norm() < 0.5;
  }

  // The cone without blur: R^2 = p^2 + sigma^2 (ball_edge.h), sigma in rad by the mean scale of the edge.
  Cone sharp() const {
    double per_px = 0;
    for (const Row& row : pixels_)
      per_px += 1 / (row.slope.z() * static_cast<double>(pixels_.size()));
    Cone cone;
    cone.axis = (cone_.axis + turn_.x() * x_ + turn_.y() * y_).normalized();
    cone.half_angle = std::hypot(cone_.half_angle + turn_.z(), sigma_px_ * per_px);
    return cone;
  }
  double sigma_px() const { return sigma_px_; }

  // R^2 = 1 - residual sum of squares / total sum of squares.
  double explained() const {
    double mean = 0, all = 0, left = 0;
    for (const Row& row : pixels_) mean += row.share / static_cast<double>(pixels_.size());
    for (const Row& row : pixels_) {
      const double q = (row.inside_px + row.slope.dot(turn_)) / sigma_px_;
      const double residual = row.share - normal_at(q).below;
      left += residual * residual;
      all += (row.share - mean) * (row.share - mean);
    }
    return all > 0 ? std::clamp(1 - left / all, 0.0, 1.0) : 0;
  }

 private:
  struct Row {
    Eigen::Vector3d slope;  // d(distance inside)/d(parameters), px/rad
    double inside_px;
    double share;
  };
  Cone cone_;
  Eigen::Vector3d x_, y_;
  Eigen::Vector3d turn_ = Eigen::Vector3d::Zero();
  double sigma_px_ = 0;
  std::vector<Row> pixels_;
};

}  // namespace

SectorFrame::SectorFrame(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d across = axis.cross(Eigen::Vector3d::UnitY());
  x_ = across.norm() > 1e-9 ? Eigen::Vector3d(across.normalized()) : Eigen::Vector3d::UnitX();
  y_ = axis.cross(x_);
}

// Sector number by atan2(y, x) from -pi, without computing it: four sectors per quadrant.
std::size_t SectorFrame::sector(const Eigen::Vector3d& ray) const {
  const double x = ray.dot(x_), y = ray.dot(y_), ax = std::abs(x), ay = std::abs(y);
  constexpr double kTan = 0.41421356237309503;  // of 22.5 degrees
  const std::size_t up = static_cast<std::size_t>(ay >= kTan * ax) +
                         static_cast<std::size_t>(ay >= ax) +
                         static_cast<std::size_t>(kTan * ay >= ax);
  if (y >= 0) return x >= 0 ? 8 + up : 15 - up;
  return x >= 0 ? 7 - up : up;
}

std::optional<EdgeFit> fit_edge(const Image& image, const CameraModel& camera, const Cone& cone,
                                const EdgeSectors& seen) {
  const double pixel = 1 / std::sqrt(camera.fx * camera.fy);
  EdgeFit fitted{cone, 0, 0};
  double sigma_px = 0.7;
  // Two rounds: the colours on both sides of the edge are sampled again with the improved cone.
  for (int round = 0; round < 2; ++round) {
    const std::vector<Pixel> pixels = with_shares(pixels_beside(image, camera, fitted.cone), seen);
    if (pixels.size() < kMinPixels) return std::nullopt;
    BlurredEdge edge(pixels, fitted.cone);
    if (!edge.fit(camera, sigma_px)) return std::nullopt;
    sigma_px = edge.sigma_px();
    fitted = {edge.sharp(), edge.explained(), sigma_px};
    const double max_change = std::max(1.2 * pixel, 0.35 * cone.half_angle);
    if (std::abs(fitted.cone.half_angle - cone.half_angle) > max_change ||
        std::acos(std::min(1.0, fitted.cone.axis.dot(cone.axis))) > max_change)
      return std::nullopt;
  }
  return fitted;
}

}  // namespace kaz::vision
