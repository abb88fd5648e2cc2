// Culling by bounding spheres, order from near to far, level of detail.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/visible.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/render/model/projection.h"

namespace kaz::sim {

namespace {

constexpr double kSmall = 14;  // samples; pieces of a smaller radius use the coarse mesh

}  // namespace

Result<void> check_view(std::size_t frames, const ScenePose& pose, const View& view) {
  if (pose.frames.size() != frames) {
    return fail(Fault::usage, "the pose has " + std::to_string(pose.frames.size()) +
                                  " frames, but the scene has " + std::to_string(frames) +
                                  " frames");
  }
  const vision::CameraModel& c = view.camera;
  const int n = view.samples_per_axis;
  if (n < 1 || n > 4 || c.width < 1 || c.height < 1 || c.width > kLargestSide / n ||
      c.height > kLargestSide / n) {
    return fail(Fault::usage, "a picture of " + std::to_string(c.width) + " x " +
                                  std::to_string(c.height) + " with " + std::to_string(n) +
                                  " samples per axis cannot be drawn: a pixel must have 1 to 4 "
                                  "samples per axis, and each row and each column of the "
                                  "picture must have 1 to " +
                                  std::to_string(kLargestSide) + " samples");
  }
  if (const auto& part = view.part;
      part && !(0 <= part->left && part->left < part->right && part->right <= c.width &&
                0 <= part->top && part->top < part->bottom && part->bottom <= c.height)) {
    return fail(Fault::usage,
                "a part of a picture must have at least one column and one row, and lie inside the "
                "picture");
  }
  if (!(c.fx > 0 && c.fy > 0 && std::isfinite(c.fx + c.fy + c.cx + c.cy))) {
    return fail(Fault::usage, "a camera needs positive focal lengths and a finite center");
  }
  const Light& light = view.light;
  // Shadows of a lower lamp would extend beyond the shadow map.
  if (!light.to_key.allFinite() || !(light.to_key.z() > 0.05 * light.to_key.norm()) ||
      !(light.key >= 0 && light.shaded >= 0 && std::isfinite(light.key + light.shaded))) {
    return fail(Fault::usage,
                "a lamp must be at least 3 degrees above the horizon, and its brightness factors "
                "must be at "
                "least 0");
  }
  return {};
}

std::vector<VisiblePiece> visible_pieces(const SceneModel& model, const ScenePose& pose,
                                         const View& view) {
  const Eigen::Isometry3d optical_from_world = view.world_from_optical.inverse();
  std::vector<VisiblePiece> visible;
  visible.reserve(model.pieces.size());
  for (const Piece& piece : model.pieces) {
    const Eigen::Vector3d center =
        optical_from_world * (pose.frames[static_cast<std::size_t>(piece.frame)] * piece.center);
    if (!may_be_seen(view.camera, center, piece.radius)) continue;
    // Radius of the piece in samples: bevels and facets of small pieces are below a pixel.
    const double samples = view.samples_per_axis * view.camera.fx * piece.radius / center.z();
    const bool coarse = center.z() > piece.radius && samples < kSmall;
    visible.push_back({&piece, center.norm() - piece.radius, !coarse});
  }
  std::stable_sort(visible.begin(), visible.end(),
                   [](const VisiblePiece& a, const VisiblePiece& b) {
                     const bool a_textured = a.piece->texture >= 0;
                     const bool b_textured = b.piece->texture >= 0;
                     if (a.piece->ground != b.piece->ground) return b.piece->ground;
                     if (a_textured != b_textured) return b_textured;
                     return a.distance < b.distance;
                   });
  return visible;
}

}  // namespace kaz::sim
