// Splits a picture into parts where a flat ground may be in shadow, and parts where the ground is lit. The
// shadow map is only needed in the parts that may be in shadow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "sim/render/model/scene_model.h"
#include "sim/render/renderer.h"

namespace kaz::sim {

// Rectangle of samples. The row number `y` counts from the first row in memory.
struct PictureRectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

// Plane of a flat ground. All points `x` of the plane satisfy `normal . x = distance` (world frame, m). The
// normal points to the lit side.
struct GroundPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance = 0;
};

// Rectangles that cover the picture without overlap.
struct GroundParts {
  std::vector<PictureRectangle> shaded, lit;
};

// Splits a picture into shaded and lit parts. If the bounding sphere of a caster casts a shadow on a sample
// of the ground, a rectangle of `GroundParts::shaded` contains the sample. Each sphere is enlarged by
// `edge_m`, the width of a shadow's edge, measured perpendicular to the light.
GroundParts parts_of_ground(std::span<const Piece> pieces, const ScenePose& pose, const View& view,
                            const GroundPlane& ground, double edge_m);

}  // namespace kaz::sim
