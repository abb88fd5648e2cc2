// External view of the simulated world that contains the robot and the ball.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "sim/body/description/scene.h"
#include "sim/render/renderer.h"

namespace kaz::tools {

// Position and size of the view's subject. World frame, m.
struct Framing {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double extent_m = 0;  // length of the diagonal of a box around the subject
};

// Returns whether a scene frame belongs to the robot or to the model `ball`.
bool is_subject(const std::string& frame);

// Returns the center and size of a box around the robot and the model `ball`. Leaves the ball out if its
// distance is 1.5 m or more.
Framing framing_of(const sim::Scene& scene, const sim::ScenePose& pose);

// Returns a 4 : 3 view, `width` px wide, drawn with the light of the scene.
sim::View outside_view(const sim::Scene& scene, const Framing& framing, int width);

}  // namespace kaz::tools
