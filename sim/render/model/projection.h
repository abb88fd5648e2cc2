// Computes projection matrices to clip space, and checks whether spheres are in the view frustum.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Geometry>

#include "sim/render/model/scene_model.h"
#include "sim/render/renderer.h"

namespace kaz::sim {

// Returns the projection from the optical frame to OpenGL's clip space. The y axis of the clip space points
// down, so the first row in memory is the top row of the picture. The matrix is column-major.
Eigen::Matrix4d clip_from_optical(const vision::CameraModel& camera);

// Returns false if the sphere (optical frame, m) is outside the view frustum. The far plane is ignored.
bool may_be_seen(const vision::CameraModel& camera, const Eigen::Vector3d& center, double radius);

inline constexpr double kNear_m = 0.008, kFar_m = 40.0;

// Orthographic view in the direction of the key light, for a shadow map.
struct ShadowView {
  Eigen::Matrix4d clip_from_world;
  Eigen::Matrix4d texture_from_world;  // maps points in the view to 0..1 in all three coordinates
};
// Fits the view to the shadow casters. `texels` is the side length of the shadow map in texels. The outermost
// ring of texels stays free. `to_key` is the direction to the key light. The center of the view moves in
// steps of whole texels. Therefore, if one object moves, the shadow edges of objects at rest do not flicker.
// If a caster is more than 1.5 m from the mean position of all casters, the caster's shadow may be missing or
// incomplete.
ShadowView fit_shadow_view(std::span<const Piece> pieces, const ScenePose& pose, int texels,
                           const Eigen::Vector3d& to_key);

}  // namespace kaz::sim
