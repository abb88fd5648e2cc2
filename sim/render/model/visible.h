// Selects the visible pieces of a scene and validates views, for all renderers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "shared/base/result.hpp"
#include "sim/render/model/scene_model.h"
#include "sim/render/renderer.h"

namespace kaz::sim {

// Maximum width and height of a picture, in samples.
inline constexpr int kLargestSide = 8192;

// Checks whether a view and a pose can be drawn. `frames` is the number of frames of the scene. If the view
// or the pose is invalid, returns Fault::usage with the reason.
Result<void> check_view(std::size_t frames, const ScenePose& pose, const View& view);

struct VisiblePiece {
  const Piece* piece;
  // Distance from the eye to the bounding sphere, m; negative if the eye is inside the sphere.
  double distance;
  bool fine;  // true: the piece is large in the picture, so the fine mesh is drawn
};

// Returns the pieces whose bounding spheres are at least partly inside the view frustum. The order is: first
// untextured pieces, then textured pieces, then grounds. Each group is ordered from near to far. This order
// saves time, because most hidden surfaces are drawn after the surfaces that hide them.
std::vector<VisiblePiece> visible_pieces(const SceneModel& model, const ScenePose& pose,
                                         const View& view);

}  // namespace kaz::sim
