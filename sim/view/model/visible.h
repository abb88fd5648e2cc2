// Selects the visible pieces of a scene and validates views, for all renderers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "shared/base/result.hpp"
#include "sim/view/model/scene_model.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

// Maximum width and height of a picture, in samples.
inline constexpr int kLargestSide = 8192;

// Checks a view, and a pose of a scene with `frames` frames. Returns Fault::usage with the reason if the view
// or the pose cannot be drawn.
Result<void> check_view(std::size_t frames, const ScenePose& pose, const View& view);

struct VisiblePiece {
  const Piece* piece;
  // Distance from the eye to the bounding sphere, m; negative if the eye is inside the sphere.
  double distance;
  bool fine;  // true if the piece is so large in the picture that its fine mesh is drawn
};

// Returns the pieces whose bounding spheres reach into the view: first plain pieces, then textured pieces,
// then grounds. Each group is ordered from near to far. Most hidden surfaces are thus drawn after the
// surfaces that hide them.
std::vector<VisiblePiece> visible_pieces(const SceneModel& model, const ScenePose& pose,
                                         const View& view);

}  // namespace kaz::sim
