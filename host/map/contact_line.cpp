// Rows of the floor's end, and the faces that stand there.
// SPDX-License-Identifier: Apache-2.0
#include "host/map/contact_line.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kaz::map {
namespace {

constexpr int kStanding = 2;        // points of a column, fewer are strays
constexpr double kWidest_m = 0.3;   // of a face without depth
constexpr double kStraight_px = 2;  // of a face's foot, which may be round
constexpr int kLowestFace_px = 3;
constexpr int kBeside_px = 8;          // half a block: as far as a rim's depth reaches beside it
constexpr float kSameThing_m = 0.05F;  // between the feet of columns of one thing
constexpr float kLowerThan_m = 0.01F;  // by how much the top of a thing may seem lower than its rim
constexpr float kDeepest_m = 0.15F;    // of a thing whose height is not known

}  // namespace

void ContactLine::begin(const vision::PlaneSegments& planes, const std::array<bool, 256>& floor,
                        const Eigen::Isometry3d& map_from_eye) {
  planes_ = &planes;
  floor_ = &floor;
  eye_ = map_from_eye;
  columns_.assign(static_cast<std::size_t>(planes.width), {});
}

bool ContactLine::floor_at(int u, int v) const {
  const auto width = static_cast<std::size_t>(planes_->width);
  return (
      *floor_)[planes_->label[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)]];
}

void ContactLine::enter_row(int v) {
  const std::uint8_t* label =
      planes_->label.data() + static_cast<std::ptrdiff_t>(v) * planes_->width;
  for (Column& column : columns_) column.floor_row = (*floor_)[*label++] ? v : column.floor_row;
}

Eigen::Vector3f ContactLine::ray_above(int u, int v) const {
  return (eye_.linear() * planes_->info.camera.ray(u, v - 0.5)).cast<float>();
}

float ContactLine::distance_above(int u, int v) const {
  const Eigen::Vector3f ray = ray_above(u, v);
  const auto height = static_cast<float>(eye_.translation().z());
  return ray.z() < 0 ? height / -ray.z() * ray.head<2>().norm() : 0;
}

float ContactLine::distance(int u) const {
  const Column& column = columns_[static_cast<std::size_t>(u)];
  return column.floor_row < 0 ? 0 : distance_above(u, column.floor_row);
}

void ContactLine::add(int u, float votes, float height_m) {
  Column& column = columns_[static_cast<std::size_t>(u)];
  if (column.top_row != column.floor_row) {
    column.top_row = column.floor_row;
    column.foot_m = distance(u);
    column.top_m = 0;
  }
  column.top_m = std::max(column.top_m, height_m);
  if (column.points == 0) column.row = column.floor_row;
  column.votes += votes;
  ++column.points;
}

bool ContactLine::mixed(int u, float distance_m, float height_m) const {
  const float foot_m = distance(u);
  if (foot_m <= 0) return false;
  float top_m = 0;
  const int first = std::max(0, u - kBeside_px),
            last = std::min(planes_->width - 1, u + kBeside_px);
  for (int k = first; k <= last; ++k) {
    const Column& column = columns_[static_cast<std::size_t>(k)];
    if (column.top_row >= 0 && std::abs(column.foot_m - foot_m) < kSameThing_m)
      top_m = std::max(top_m, column.top_m);
  }
  return top_m > 0 ? height_m < top_m - kLowerThan_m : distance_m > foot_m + kDeepest_m;
}

int ContactLine::end_near(int u, double expected, int rows,
                          const std::vector<std::uint8_t>& own) const {
  const int lowest = std::min(planes_->height - 1, static_cast<int>(expected + kStraight_px));
  const int highest = std::max(rows, static_cast<int>(std::ceil(expected - kStraight_px)));
  for (int v = lowest; v >= highest; --v) {
    if (!floor_at(u, v) || floor_at(u, v - 1)) continue;
    for (int above = v - 1; above >= v - rows; --above) {
      const auto pixel = static_cast<std::size_t>(above * planes_->width + u);
      if (floor_at(u, above) || own[pixel] != 0) return -1;
    }
    return v;
  }
  return -1;
}

const std::vector<ContactLine::Filled>& ContactLine::plain_faces(
    int stride, double low_m, const std::vector<std::uint8_t>& own) {
  const vision::CameraModel& c = planes_->info.camera;
  filled_.clear();
  int before = -1;
  for (int u = stride / 2; u < planes_->width; u += stride) {
    const Column& right = columns_[static_cast<std::size_t>(u)];
    if (right.points < kStanding) continue;
    const int first = std::exchange(before, u);
    if (first < 0 || u - first <= stride) continue;
    const Column& left = columns_[static_cast<std::size_t>(first)];
    const double z = std::max(distance_above(u, right.row), distance_above(first, left.row));
    if ((u - first) * z > kWidest_m * c.fx) continue;
    const int rows = std::max(kLowestFace_px, static_cast<int>(low_m * c.fy / z));
    const std::size_t so_far = filled_.size();
    for (int at = first + stride; at < u; at += stride) {
      const float part = static_cast<float>(at - first) / static_cast<float>(u - first);
      const double straight = left.row + static_cast<double>(part) * (right.row - left.row);
      const int end = end_near(at, straight, rows, own);
      if (end < 0) {
        filled_.resize(so_far);
        break;
      }
      filled_.push_back({ray_above(at, end), distance_above(at, end),
                         left.votes + part * (right.votes - left.votes),
                         std::min(left.points, right.points)});
    }
  }
  return filled_;
}

}  // namespace kaz::map
