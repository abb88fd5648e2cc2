// What of a scene a view shows, and whether a view can be drawn: shared by all renderers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "shared/base/result.hpp"
#include "sim/view/model/scene_model.h"
#include "sim/view/renderer.h"

namespace kaz::sim {

// Largest side of a picture, px, samples included.
inline constexpr int kLargestSide = 8192;

// Error: why the view, or the pose of a scene of `frames` frames, cannot be drawn.
Result<void> check_view(std::size_t frames, const ScenePose& pose, const View& view);

struct VisiblePiece {
  const Piece* piece;
  double distance;  // from the eye to the bounding sphere, m; negative inside it
  bool fine;        // the piece is large enough in the picture for its fine mesh
};

// Pieces whose bounding spheres reach into the view, from near to far: plain ones, textured ones, grounds
// (everything is in front of them). Hidden surfaces then mostly come after what hides them.
std::vector<VisiblePiece> visible_pieces(const SceneModel& model, const ScenePose& pose,
                                         const View& view);

}  // namespace kaz::sim
