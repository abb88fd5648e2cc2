// Projection of pictures and of the shadow map.
// SPDX-License-Identifier: Apache-2.0
#include "sim/render/model/projection.h"

#include <algorithm>
#include <cmath>

namespace kaz::sim {

Eigen::Matrix4d clip_from_optical(const vision::CameraModel& camera) {
  // Pixel u to clip space: x = 2 (u + 0.5) / width - 1 with u = f_x X / Z + c_x, rows alike; depth as
  // glFrustum (OpenGL 2.1 reference) for Z forward in [kNear_m, kFar_m]; w = Z.
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = 2 * camera.fx / camera.width;
  m(0, 2) = (2 * camera.cx + 1) / camera.width - 1;
  m(1, 1) = 2 * camera.fy / camera.height;
  m(1, 2) = (2 * camera.cy + 1) / camera.height - 1;
  m(2, 2) = (kFar_m + kNear_m) / (kFar_m - kNear_m);
  m(2, 3) = -2 * kFar_m * kNear_m / (kFar_m - kNear_m);
  m(3, 2) = 1;
  return m;
}

bool may_be_seen(const vision::CameraModel& camera, const Eigen::Vector3d& center, double radius) {
  if (center.z() < kNear_m - radius) return false;
  // Signed distance to the four side planes through the optical centre: (x + slope z) / sqrt(1 + slope^2).
  const double left = (camera.cx + 0.5) / camera.fx;
  const double right = (camera.width - 0.5 - camera.cx) / camera.fx;
  const double top = (camera.cy + 0.5) / camera.fy;
  const double bottom = (camera.height - 0.5 - camera.cy) / camera.fy;
  const auto outside = [&](double across, double slope) {
    return across + slope * center.z() < -radius * std::sqrt(1 + slope * slope);
  };
  return !outside(center.x(), left) && !outside(-center.x(), right) && !outside(center.y(), top) &&
         !outside(-center.y(), bottom);
}

// Light frame: x, y across the light, z along it. The map covers the casters' bounding spheres within kReach
// of their mean, m.
ShadowView fit_shadow_view(std::span<const Piece> pieces, const ScenePose& pose, int texels,
                           const Eigen::Vector3d& to_key) {
  const Eigen::Vector3d back = to_key.normalized();
  Eigen::Matrix3d light_from_world;
  light_from_world.row(0) = Eigen::Vector3d::UnitY().cross(back).normalized();
  light_from_world.row(1) = back.cross(Eigen::Vector3d(light_from_world.row(0)));
  light_from_world.row(2) = -back;

  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto in_light = [&](const Piece& piece) -> Eigen::Vector3d {
    return light_from_world * (pose.frames[static_cast<std::size_t>(piece.frame)] * piece.center);
  };
  int casters = 0;
  for (const Piece& piece : pieces) {
    if (piece.caster_count == 0) continue;
    mean += in_light(piece);
    ++casters;
  }
  if (casters > 0) mean /= casters;
  // Most casters are parts of the robot, so their mean is near it. Casters further off than kReach cast no
  // shadow: the map would become too coarse.
  constexpr double kReach = 1.5, kStep = 0.125;
  Eigen::Array3d low = mean, high = mean;
  for (const Piece& piece : pieces) {
    if (piece.caster_count == 0) continue;
    const Eigen::Array3d c = in_light(piece);
    low = low.min(c - piece.radius);
    high = high.max(c + piece.radius);
  }
  const Eigen::Array2d low_xy = low.head<2>().max(mean.head<2>().array() - kReach);
  const Eigen::Array2d high_xy = high.head<2>().min(mean.head<2>().array() + kReach);
  double half = 0.5 * (high_xy - low_xy).maxCoeff() + 0.01;
  half = std::ceil(half / kStep) * kStep;
  const double texel = 2 * half / (texels - 2);
  const Eigen::Array2d center = (0.5 * (low_xy + high_xy) / texel).round() * texel;
  const double near = low.z() - 0.01, far = high.z() + 0.01;

  Eigen::Matrix4d clip_from_light = Eigen::Matrix4d::Identity();
  clip_from_light(0, 0) = clip_from_light(1, 1) = 1 / half;
  clip_from_light(0, 3) = -center.x() / half;
  clip_from_light(1, 3) = -center.y() / half;
  clip_from_light(2, 2) = 2 / (far - near);
  clip_from_light(2, 3) = -(far + near) / (far - near);
  Eigen::Matrix4d light = Eigen::Matrix4d::Identity();
  light.topLeftCorner<3, 3>() = light_from_world;

  // Texture coordinates 0..1 from clip space; the viewport leaves the outermost ring of texels free.
  const double inside = 0.5 * (texels - 2) / texels;
  Eigen::Matrix4d texture_from_clip = Eigen::Matrix4d::Identity();
  texture_from_clip(0, 0) = texture_from_clip(1, 1) = inside;
  texture_from_clip(2, 2) = 0.5;
  texture_from_clip.block<3, 1>(0, 3).setConstant(0.5);

  ShadowView view;
  view.clip_from_world = clip_from_light * light;
  view.texture_from_world = texture_from_clip * view.clip_from_world;
  return view;
}

}  // namespace kaz::sim
