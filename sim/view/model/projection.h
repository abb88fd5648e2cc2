// Projection matrices from world to clip space, and the test of a sphere against the view frustum.
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

// False if the sphere (optical frame, m) is outside the view frustum.
bool may_be_seen(const Pinhole& camera, const Eigen::Vector3d& center, double radius);

inline constexpr double kNear_m = 0.008, kFar_m = 40.0;

// Orthographic view from the key light onto the shadow casters.
struct ShadowView {
  Eigen::Matrix4d clip_from_world;
  Eigen::Matrix4d texture_from_world;  // 0..1 in all three
};
// `texels`: side of the map; the outermost ring stays free. The bounds move in whole texels, so that shadow
// edges do not crawl while other objects move.
ShadowView fit_shadow_view(std::span<const Piece> pieces, const ScenePose& pose, int texels,
                           const Eigen::Vector3d& to_key);

}  // namespace kaz::sim
