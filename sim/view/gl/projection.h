// Matrices from world to clip space, and what lies outside a view.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Geometry>

#include "sim/view/model/scene_model.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

// Clip space of OpenGL with y downwards, so that the first row in memory is the top row.
// Column-major.
Eigen::Matrix4d clip_from_optical(const Pinhole& camera);

// False where the sphere (optical frame) certainly lies outside the picture.
bool may_be_seen(const Pinhole& camera, const Eigen::Vector3d& center, double radius);

inline constexpr double kNear_m = 0.008, kFar_m = 40.0;

// An orthographic view from the key light onto what casts shadows.
struct ShadowView {
  Eigen::Matrix4d clip_from_world;
  Eigen::Matrix4d texture_from_world;  // 0..1 in all three
};
// `texels`: side of the map, of which the outermost ring stays free. Bounds move in whole texels,
// so that the shadows' edges do not crawl while something moves elsewhere.
ShadowView fit_shadow_view(std::span<const Piece> pieces, const ScenePose& pose, int texels,
                           const Eigen::Vector3d& to_key);

}  // namespace kaz::sim
