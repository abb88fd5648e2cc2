// Projects bounding spheres along the light onto the ground, their ellipses into the picture, and collects
// marked blocks into rectangles.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/ground_shade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "sim/render/model/projection.h"

namespace kaz::sim {
namespace {

constexpr int kBlock = 32;  // samples: half a tile of llvmpipe

using Quad = std::array<Eigen::Vector3d, 4>;

// Rectangle around the ellipse in which a cylinder along the light l (unit, towards the lamp) intersects the
// ground (n, d); world frame, m. Centre c - l (n . c - d) / (n . l); half axes r across the light and
// r / (n . l) along it.
Quad around_shadow(const Eigen::Vector3d& center, double radius, const GroundPlane& ground,
                   const Eigen::Vector3d& to_key) {
  const double steep = ground.normal.dot(to_key);
  const double above = ground.normal.dot(center) - ground.distance;
  const Eigen::Vector3d middle = center - to_key * (above / steep);
  const Eigen::Vector3d across = ground.normal.cross(to_key);
  // With vertical light the ellipse is a circle: any direction will do.
  const Eigen::Vector3d b =
      across.norm() > 1e-9 ? across.normalized() : ground.normal.unitOrthogonal();
  const Eigen::Vector3d wide = b * radius, far = ground.normal.cross(b) * (radius / steep);
  return {middle - wide - far, middle + wide - far, middle + wide + far, middle - wide + far};
}

// The blocks of a picture, marked or not.
class Blocks {
 public:
  Blocks(int width, int height)
      : width_(width),
        height_(height),
        columns_((width + kBlock - 1) / kBlock),
        rows_((height + kBlock - 1) / kBlock),
        marked_(static_cast<std::size_t>(columns_ * rows_)) {}

  // Marks all blocks that intersect the bounds (samples), with a margin of one sample for rounding.
  void mark(double left, double top, double right, double bottom) {
    const auto block = [](double at, int count) {
      return static_cast<int>(std::clamp(std::floor(at / kBlock), -1.0, double(count)));
    };
    const int first = std::max(block(left - 1, columns_), 0);
    const int last = std::min(block(right + 1, columns_), columns_ - 1);
    const int end = std::min(block(bottom + 1, rows_), rows_ - 1);
    for (int y = std::max(block(top - 1, rows_), 0); y <= end; ++y) {
      for (int x = first; x <= last; ++x) at(x, y) = 1;
    }
  }

  GroundParts take_parts() {
    GroundParts parts{take(1), {}};
    parts.lit = take(0);
    return parts;
  }

 private:
  enum : std::uint8_t { taken = 2 };

  // Greedy rectangle cover: each run of a row is extended downwards while the rows below contain it.
  std::vector<PictureRectangle> take(std::uint8_t kind) {
    std::vector<PictureRectangle> rectangles;
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        if (at(x, y) != kind) continue;
        int end = x, below = y + 1;
        while (end < columns_ && at(end, y) == kind) ++end;
        while (below < rows_ && all(x, end, below, kind)) ++below;
        for (int row = y; row < below; ++row) {
          for (int column = x; column < end; ++column) at(column, row) = taken;
        }
        rectangles.push_back({x * kBlock, y * kBlock, std::min(end * kBlock, width_) - x * kBlock,
                              std::min(below * kBlock, height_) - y * kBlock});
      }
    }
    return rectangles;
  }

  std::uint8_t& at(int x, int y) { return marked_[static_cast<std::size_t>(y * columns_ + x)]; }
  bool all(int first, int end, int y, std::uint8_t kind) {
    while (first < end && at(first, y) == kind) ++first;
    return first == end;
  }

  int width_, height_, columns_, rows_;
  std::vector<std::uint8_t> marked_;
};

}  // namespace

GroundParts parts_of_ground(std::span<const Piece> pieces, const ScenePose& pose, const View& view,
                            const GroundPlane& ground, double edge_m) {
  const Eigen::Vector3d to_key = view.light.to_key.normalized();
  const int n = view.samples_per_axis;
  const vision::CameraModel& camera = view.camera;
  const Eigen::Isometry3d optical_from_world = view.world_from_optical.inverse();
  Blocks blocks(camera.width * n, camera.height * n);
  const auto mark_shadow = [&](const Eigen::Vector3d& center, double radius) {
    if (ground.normal.dot(center) < ground.distance - radius) return;  // below the ground
    Quad quad = around_shadow(center, radius, ground, to_key);
    for (Eigen::Vector3d& corner : quad) corner = optical_from_world * corner;
    // Bounding box in samples of the quad clipped at the near plane (optical frame): u = n (f_x x / z + c_x +
    // 0.5) for corners in front of it and for intersections of the sides with it.
    double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
    const auto reach = [&](const Eigen::Vector3d& p) {
      const double u = n * (camera.fx * p.x() / p.z() + camera.cx + 0.5);
      const double v = n * (camera.fy * p.y() / p.z() + camera.cy + 0.5);
      left = std::min(left, u);
      right = std::max(right, u);
      top = std::min(top, v);
      bottom = std::max(bottom, v);
    };
    for (std::size_t i = 0; i < quad.size(); ++i) {
      const Eigen::Vector3d &a = quad[i], &b = quad[(i + 1) % quad.size()];
      if (a.z() >= kNear_m) reach(a);
      if ((a.z() < kNear_m) != (b.z() < kNear_m))
        reach(a + (b - a) * ((kNear_m - a.z()) / (b.z() - a.z())));
    }
    if (left <= right) blocks.mark(left, top, right, bottom);
  };
  for (const Piece& piece : pieces) {
    const Eigen::Isometry3d& frame = pose.frames[static_cast<std::size_t>(piece.frame)];
    for (const BoundingSphere& caster : piece.casters)
      mark_shadow(frame * caster.center, caster.radius + edge_m);
  }
  return blocks.take_parts();
}

}  // namespace kaz::sim
