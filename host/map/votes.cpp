// Votes of an update: floor pixels against, obstacle points for an obstacle in a cell.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/votes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kaz::map {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNearest_m = 0.03;  // minimum depth

// Labels of floor segments. Stricter than vision: a segment whose centre is above obstacle_m is an obstacle.
std::array<bool, 256> floor_labels(const vision::PlaneSegments& planes,
                                   const Eigen::Isometry3d& eye, double obstacle_m) {
  std::array<bool, 256> floor{};
  for (std::size_t k = 0; k < planes.segments.size() && k < 255; ++k) {
    const vision::PlaneSegment& s = planes.segments[k];
    floor[k + 1] = s.floor && (eye * s.middle).z() < obstacle_m;
  }
  return floor;
}

std::int16_t added(std::int16_t odds, int steps) {
  constexpr int kFull = static_cast<int>(kMaxOdds / kStep),
                kFloor = static_cast<int>(kMaxFloorOdds / kStep);
  return static_cast<std::int16_t>(std::clamp(odds + steps, -kFloor, kFull));
}

// Limits of an obstacle point, in single precision.
struct PointLimits {
  float low, high, deep;  // heights above and depth below the floor, m
  float farthest2, own2;  // squared distances along the floor, m^2
  float error;            // standard deviation of the disparity, px
};

PointLimits point_limits(const LocalMapOptions& options) {
  return {.low = static_cast<float>(options.obstacle_m),
          .high = static_cast<float>(options.robot_m),
          .deep = static_cast<float>(options.drop_m),
          .farthest2 = static_cast<float>(options.farthest_m * options.farthest_m),
          .own2 = static_cast<float>(options.own_m * options.own_m),
          .error = static_cast<float>(options.disparity_error_px)};
}

// Intersects [from, to] with the half-line a + b k >= 0.
void keep_above(double a, double b, double& from, double& to) {
  if (b > 0) {
    from = std::max(from, -a / b);
  } else if (b < 0) {
    to = std::min(to, -a / b);
  } else if (a < 0) {
    to = from - 1;
  }
}

}  // namespace

// Projects the centre of each floor cell into the image: h = K R^T (p - eye), homogeneous (u w, v w, w), map
// frame to optical frame. Along a row of cells (y increasing) h is linear in the cell's number k, so the
// visible cells are an interval of k, clipped by the four image borders, the minimum depth and the maximum
// range. Each visible cell whose pixel is labelled floor gets a vote against an obstacle, weighted by
// min(1, (z0 / z)^2): the accuracy of stereo depth decreases with z^2.
// At the picture's sides floor is not believed: what they cut off a thing is too narrow for the floor's
// edges.
// Where points are taken for the robot's own body, floor does not clear what was seen from afar, several
// times: a thin rod beside the feet would be forgotten.
void LocalMap::see_floor(const View& view, const vision::PlaneSegments& planes,
                         const Vector2d& foot) {
  const vision::CameraModel& c = view.camera;
  const std::array<bool, 256> floor = floor_labels(planes, view.eye, options_.obstacle_m);
  if (std::find(floor.begin(), floor.end(), true) == floor.end()) return;
  Matrix3d k;
  k << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
  const Matrix3d turn = k * view.eye.linear().transpose();
  const Vector3d eye = view.eye.translation(), step = turn.col(1) * options_.cell_m;
  if (eye.z() <= 0) return;  // below the floor: none of it is visible
  const auto update = static_cast<std::uint32_t>(counts_.updates);
  const int width = c.width, height = c.height;
  const double side = kSide * width, right = width - side;
  const double own2 = options_.own_m * options_.own_m;
  constexpr int kept = static_cast<int>(kKeptBeside / kStep);
  int *const row_u = row_u_.data(), *const row_v = row_v_.data(),
             *const row_vote = row_vote_.data();
  const int first_x = std::max(0, number(eye.x() - options_.farthest_m));
  const int last_x = std::min(cells_ - 1, number(eye.x() + options_.farthest_m));
  for (int x = first_x; x <= last_x; ++x) {
    const double dx = middle(x) - eye.x();
    const double aside = options_.farthest_m * options_.farthest_m - dx * dx;
    if (aside < 0) continue;
    const double reach = std::sqrt(aside) / options_.cell_m;
    const double under = (eye.y() - middle(0)) / options_.cell_m;
    double from = std::max(0.0, under - reach), to = std::min(cells_ - 1.0, under + reach);
    const Vector3d at = turn * (Vector3d(middle(x), middle(0), 0) - eye);
    keep_above(at.z() - kNearest_m, step.z(), from, to);
    keep_above(at.x() + (0.5 - side) * at.z(), step.x() + (0.5 - side) * step.z(), from, to);
    keep_above(at.y() + 0.5 * at.z(), step.y() + 0.5 * step.z(), from, to);
    keep_above((right - 0.5) * at.z() - at.x(), (right - 0.5) * step.z() - step.x(), from, to);
    keep_above((height - 0.5) * at.z() - at.y(), (height - 0.5) * step.z() - step.y(), from, to);
    if (from > to) continue;
    // Single precision, for SIMD: error of a thousandth of a pixel.
    const int first = static_cast<int>(std::ceil(from)), count = static_cast<int>(to) - first + 1;
    const Eigen::Vector3f at0 = (at + first * step).cast<float>(), step1 = step.cast<float>();
    const auto votes = static_cast<float>(kFloorVote / kStep);
    const auto weight_z2 = static_cast<float>(view.weight_z2);
    for (int n = 0; n < count; ++n) {
      const auto y = static_cast<float>(n);
      const float w = 1 / (at0.z() + y * step1.z());
      row_u[n] = static_cast<int>((at0.x() + y * step1.x()) * w + 0.5F);
      row_v[n] = static_cast<int>((at0.y() + y * step1.y()) * w + 0.5F);
      row_vote[n] = static_cast<int>(votes * std::min(1.0F, weight_z2 * w * w) + 0.5F);
    }
    const std::size_t row = index(x, first);
    for (int n = 0; n < count; ++n) {
      // Rounding may put a cell at the border one pixel outside.
      const int u = std::clamp(row_u[n], 0, width - 1), v = std::clamp(row_v[n], 0, height - 1);
      if (!floor[planes.label[static_cast<std::size_t>(v * width + u)]]) continue;
      const std::size_t cell = row + static_cast<std::size_t>(n);
      if (odds_[cell] > kept &&
          (Vector2d(middle(x), middle(first + n)) - foot).squaredNorm() < own2)
        continue;
      odds_[cell] = added(odds_[cell], -row_vote[n]);
      seen_[cell] = update;
    }
  }
}

// Discs along the capsule's line, each as large as a sphere of its radius appears there: radius fx / z. At
// its outline block matching mixes its disparity with that of what is behind, within half a block and beside.
void LocalMap::mask(const OwnPart& part, const vision::FrameInfo& info) {
  constexpr double kStep_m = 0.004, kMargin = 10.0 / 320;  // of the picture's width
  const vision::CameraModel& c = info.camera;
  const Eigen::Isometry3d eye_from_foot = info.foot_from_eye.inverse();
  const Vector3d from = eye_from_foot * part.from, to = eye_from_foot * part.to;
  const int steps = 1 + static_cast<int>((to - from).norm() / kStep_m);
  for (int i = 0; i <= steps; ++i) {
    const Vector3d p = from + (to - from) * i / steps;
    if (!(p.z() > kNearest_m)) continue;
    const Vector2d px = c.pixel(p);
    const double u = px.x(), v = px.y();
    const double radius = c.fx * part.radius_m / p.z() + kMargin * c.width;
    const int first = static_cast<int>(std::clamp(std::ceil(v - radius), 0.0, 1.0 * c.height));
    const int last = static_cast<int>(std::clamp(std::floor(v + radius), -1.0, c.height - 1.0));
    for (int row = first; row <= last; ++row) {
      const double half = std::sqrt(std::max(0.0, radius * radius - (row - v) * (row - v)));
      const auto left =
          static_cast<std::ptrdiff_t>(std::clamp(std::ceil(u - half), 0.0, 1.0 * c.width));
      const auto right =
          static_cast<std::ptrdiff_t>(std::clamp(std::floor(u + half) + 1, 0.0, 1.0 * c.width));
      const auto begin = own_.begin() + static_cast<std::ptrdiff_t>(row) * c.width;
      if (left < right) std::fill(begin + left, begin + right, std::uint8_t{1});
    }
  }
}

// Back-projects pixels that are not floor: p = eye + z R r, z = f B / d, map frame, in single precision
// (error below 0.01 mm). A point counts if its height is within (obstacle_m, robot_m) and above 3 standard
// deviations of its own error, dz = z^2 / (f B) dd times the ray's slope. Depth errors scatter points behind
// an edge over visible floor: such a point is moved up to 2 standard deviations along the ray to a cell that
// is not. A point that agrees with the end of the floor below it stands there. Each adds share
// min(z^2, z0^2): the area of a pixel at depth z in cells.
void LocalMap::see_obstacles(const View& view, const vision::PlaneSegments& planes,
                             const vision::DepthImage& depth, const Vector2d& foot) {
  const vision::CameraModel& c = view.camera;
  const std::array<bool, 256> floor = floor_labels(planes, view.eye, options_.obstacle_m);
  const auto update = static_cast<std::uint32_t>(counts_.updates);
  // Sampling of pixels: about two per cell horizontally at 1 m, one vertically.
  const int stride = std::max(1, depth.width / 320), stride_v = std::max(1, depth.width / 160);
  const Eigen::Vector3f eye = view.eye.translation().cast<float>();
  const Eigen::Vector3f along = (view.eye.linear().col(0) / c.fx).cast<float>();
  const auto fb = static_cast<float>(view.fb);
  const auto [low, high, deep, farthest2, own2, error] = point_limits(options_);
  const auto weight_z2 = static_cast<float>(view.weight_z2);
  // Share of a full vote of one pixel at 1 m.
  const auto share = static_cast<float>(kFullAt * stride * stride_v /
                                        (c.fx * options_.cell_m * c.fx * options_.cell_m));
  const auto nearest_d = static_cast<float>(view.fb / kNearest_m);
  const auto per_m = static_cast<float>(1 / options_.cell_m),
             half = 0.5F * static_cast<float>(cells_);
  const auto cells = static_cast<float>(cells_);
  const auto cell_of = [&](float z, const Eigen::Vector3f& ray) {
    const float x = (eye.x() + z * ray.x()) * per_m + half;
    const float y = (eye.y() + z * ray.y()) * per_m + half;
    if (!(x >= 0 && y >= 0 && x < cells && y < cells)) return -1;
    return static_cast<int>(index(static_cast<int>(x), static_cast<int>(y)));
  };
  const int width = depth.width;
  float* const up = row_up_.data();
  const auto enter = [&](int cell, float votes, int points) {
    const auto i = static_cast<std::size_t>(cell);
    if (hits_[i] == 0) touched_.push_back(static_cast<std::uint32_t>(cell));
    hits_[i] += votes;
    points_[i] = static_cast<std::uint16_t>(points_[i] + points);
  };
  const auto is_floor = [&](int cell) {
    return cell >= 0 && seen_[static_cast<std::size_t>(cell)] == update;
  };
  // The cell of a thing that stands where the floor ends: just beyond it, and not itself seen to be floor.
  const auto cell_beyond = [&](float distance, const Eigen::Vector3f& ray) {
    int cell = -1;
    for (const float halves : {1.0F, 2.0F, 3.0F}) {
      cell = cell_of((distance + 0.5F * halves / per_m) / ray.head<2>().norm(), ray);
      if (!is_floor(cell)) break;
    }
    return cell;
  };
  contact_.begin(planes, floor, view.eye);
  for (int v = depth.height - 1; v >= 0; --v) {
    contact_.enter_row(v);
    if (v % stride_v != stride_v / 2) continue;
    const Eigen::Vector3f start = (view.eye.linear() * Vector3d(-c.cx / c.fx, (v - c.cy) / c.fy, 1))
                                      .cast<float>();  // of the ray at u = 0
    const float* d = depth.disparity_px.data() + static_cast<std::ptrdiff_t>(v) * width;
    const float* above = v >= stride_v ? d - stride_v * width : d;
    const float* below = v + stride_v < depth.height ? d + stride_v * width : d;
    const std::uint8_t* label = planes.label.data() + static_cast<std::ptrdiff_t>(v) * width;
    const std::uint8_t* own = own_.data() + static_cast<std::ptrdiff_t>(v) * width;
    for (int u = 0; u < width; ++u)
      up[u] = eye.z() + fb / d[u] * (start.z() + static_cast<float>(u) * along.z());
    for (int u = stride / 2; u < width; u += stride) {
      const bool drop = up[u] < -deep;
      if (!((up[u] > low && up[u] < high) || drop) || floor[label[u]] || own[u] != 0) continue;
      if (!(d[u] > 0 && d[u] < nearest_d)) continue;
      if (!(std::abs(above[u] - d[u]) < kSmooth_px && std::abs(below[u] - d[u]) < kSmooth_px))
        continue;
      const Eigen::Vector3f ray = start + static_cast<float>(u) * along;
      const float z = fb / d[u];
      if (std::abs(up[u]) < 3 * z * z / fb * error * std::abs(ray.z())) continue;
      // Seen below the floor: there is none where the ray passes its height.
      const float reach = drop ? eye.z() / -ray.z() : z;
      const Eigen::Vector2f offset = reach * ray.head<2>();  // horizontal, from the eye
      if (offset.squaredNorm() > farthest2) continue;
      if ((eye.head<2>() + offset - foot.cast<float>()).squaredNorm() < own2) continue;
      const float votes = share * std::min(reach * reach, weight_z2);
      const float foot_m = drop ? 0 : contact_.distance(u);
      const float off_px = d[u] - fb * ray.head<2>().norm() / foot_m;  // if it stands there
      const bool beyond = foot_m > 0 && off_px < -kContactSigmas * error;
      if (beyond && contact_.mixed(u, offset.norm(), up[u])) continue;
      int cell = -1;
      if (foot_m > 0 && std::abs(off_px) < kContactSigmas * error) {
        const float height = eye.z() + foot_m / ray.head<2>().norm() * ray.z();
        contact_.add(u, votes, height);
        cell = cell_beyond(foot_m, ray);
      } else {
        cell = cell_of(reach, ray);
        for (int sigmas = 1; !drop && is_floor(cell) && sigmas <= 2; ++sigmas) {
          const float farther = d[u] - static_cast<float>(sigmas) * error;
          if (farther <= 0) break;
          const int other = cell_of(fb / farther, ray);
          if (other >= 0 && !is_floor(other)) cell = other;
        }
      }
      if (cell >= 0) enter(cell, votes, 1);
    }
  }
  for (const ContactLine::Filled& at : contact_.plain_faces(stride, options_.obstacle_m, own_)) {
    const int cell = cell_beyond(at.distance_m, at.ray);
    if (cell >= 0) enter(cell, at.votes, at.points);
  }
}

// A vertical face has its points over few cells; depth errors scatter a few of them in front of and behind
// it. So a cell's vote is reduced by its ratio to the strongest neighbour, with a factor kUneven for the
// uneven distribution of pixel rows over cells.
void LocalMap::enter_obstacles(const View& view, int width) {
  const int stride = std::max(1, width / 320), stride_v = std::max(1, width / 160);
  const double points_at_1_m =
      options_.obstacle_m * options_.cell_m * view.camera.fx * view.camera.fy / (stride * stride_v);

  for (const std::uint32_t cell : touched_) {
    const float hits = hits_[cell];
    const int x = static_cast<int>(cell) / cells_, y = static_cast<int>(cell) % cells_;
    float max_hits = hits;
    int points = 0;
    for (int i = std::max(0, x - 1); i <= std::min(cells_ - 1, x + 1); ++i) {
      for (int j = std::max(0, y - 1); j <= std::min(cells_ - 1, y + 1); ++j) {
        max_hits = std::max(max_hits, hits_[index(i, j)]);
        points += points_[index(i, j)];
      }
    }
    const Eigen::Vector2d at(middle(x), middle(y));
    const double z2 = (at - view.eye.translation().head<2>()).squaredNorm() +
                      view.eye.translation().z() * view.eye.translation().z();
    if (points < std::max<double>(kMinPoints, kMinShare * points_at_1_m / z2)) continue;
    const double vote =
        static_cast<double>(std::min(1.0F, hits) * std::min(1.0F, kUneven * hits / max_hits));
    odds_[cell] = added(odds_[cell], static_cast<int>(std::lround(vote * kObstacleVote / kStep)));
  }
  for (const std::uint32_t cell : touched_) hits_[cell] = 0, points_[cell] = 0;
  touched_.clear();
}

}  // namespace kaz::map
