// External view that contains the robot and the ball.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "sim/body/description/scene.h"
#include "sim/view/renderer.h"

namespace kaz::tools {

// Subject of the view. World frame, m.
struct Framing {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double extent_m = 0;  // diagonal of the box around the subject
};

// Returns whether a scene frame belongs to the robot or to the model `ball`.
bool is_subject(const std::string& frame);

// Returns the box around the robot and the model `ball`. Leaves out a ball 1.5 m or more away.
Framing framing_of(const sim::Scene& scene, const sim::ScenePose& pose);

// Returns a 4 : 3 view, `width` px wide, with the light of the scene.
sim::View outside_view(const sim::Scene& scene, const Framing& framing, int width);

}  // namespace kaz::tools
