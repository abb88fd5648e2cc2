// Splits a picture into parts where a flat ground may be in shadow, and parts where the ground is lit. Only
// the parts that may be in shadow need the shadow map.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "sim/view/model/scene_model.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

// Rectangle of samples. y counts from the first row in memory.
struct PictureRectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

// The lit side of the ground. Points x of the ground satisfy normal . x = distance, world frame, m.
struct GroundPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance = 0;
};

// Rectangles that together cover the picture without overlap.
struct GroundParts {
  std::vector<PictureRectangle> shaded, lit;
};

// Computes the parts conservatively: `shaded` covers every sample of the ground that may be in the shadow of
// a caster's bounding sphere. The spheres are enlarged by `edge_m`, the width of the shadow's edge
// perpendicular to the light.
GroundParts parts_of_ground(std::span<const Piece> pieces, const ScenePose& pose, const View& view,
                            const GroundPlane& ground, double edge_m);

}  // namespace kaz::sim
