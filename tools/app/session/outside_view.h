// An onlooker's view that shows robot and ball, wherever they are.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "sim/body/description/scene.h"
#include "sim/view/renderer.h"

namespace kaz::tools {

// What an onlooker looks at. World frame, m.
struct Framing {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double extent_m = 0;  // diagonal of the box around it
};

// Whether a frame of a scene is of the robot or of the model `ball`.
bool is_subject(const std::string& frame);

// The robot, and the model `ball` unless it is too far away to be in the same picture.
Framing framing_of(const sim::Scene& scene, const sim::ScenePose& pose);

// The picture is 4 : 3, `width` px wide, with the light of the scene.
sim::View outside_view(const sim::Scene& scene, const Framing& framing, int width);

}  // namespace kaz::tools
