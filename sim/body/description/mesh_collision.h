// Convex shape in place of a mesh in a collision.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "sim/body/description/reading.h"
#include "sim/body/description/scene.h"

namespace kaz::sim {

// Returns the convex shape that encloses `points` (m), and its pose in the frame of the points. A flat hull
// becomes a box.
std::pair<Shape, Eigen::Isometry3d> shape_around(std::span<const Eigen::Vector3d> points,
                                                 MeshCollision wanted);

}  // namespace kaz::sim
