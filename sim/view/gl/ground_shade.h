// Where in a picture a flat ground may lie in shadow: only there is the shadow map looked up.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "sim/view/model/scene_model.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

// Samples of a picture, from the first row in memory.
struct PictureRectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

// A side of the ground that the light falls on: points with normal . x = distance, world frame.
struct GroundPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance = 0;
};

// Rectangles that fill the picture without overlap.
struct GroundParts {
  std::vector<PictureRectangle> shaded, lit;
};

// `shaded` covers every sample of the ground in the shadow of a piece, and as far around as the
// shadow's edge may reach (`edge_m`, across the light). Shadows are those of the spheres around the
// pieces, so that more is covered than is dark.
GroundParts parts_of_ground(std::span<const Piece> pieces, const ScenePose& pose, const View& view,
                            const GroundPlane& ground, double edge_m);

}  // namespace kaz::sim
