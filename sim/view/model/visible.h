// Selects the visible pieces of a scene and validates views, for all renderers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "shared/base/result.hpp"
#include "sim/view/model/scene_model.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

// Largest side of a picture, in samples.
inline constexpr int kLargestSide = 8192;

// Returns Fault::usage with the reason if the view, or the pose of a scene of `frames` frames, cannot be
// drawn.
Result<void> check_view(std::size_t frames, const ScenePose& pose, const View& view);

struct VisiblePiece {
  const Piece* piece;
  double distance;  // from the eye to the bounding sphere, m; negative inside it
  bool fine;        // the piece is large enough in the picture for its fine mesh
};

// Returns the pieces whose bounding spheres reach into the view: plain pieces, then textured ones, then
// grounds, each from near to far. Hidden surfaces then mostly follow the surfaces that hide them.
std::vector<VisiblePiece> visible_pieces(const SceneModel& model, const ScenePose& pose,
                                         const View& view);

}  // namespace kaz::sim
