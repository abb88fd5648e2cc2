// Rules for elements of SDF that concern several of their parts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <tinyxml2.h>
#include <Eigen/Core>

#include "sim/body/description/sdf_report.h"

namespace kaz::sim {

// Checks required attributes and children. Sizes that the file does not state have SDF's defaults: a note.
void check_needs(const tinyxml2::XMLElement& element, SdfReport& report);

// Checks that an element contains no text.
void check_no_text(const tinyxml2::XMLElement& element, SdfReport& report);

// Checks kicks, planes, inertias and <self_collide> of a model. `fixed`: the model or a model around it is
// static.
void check_model(const tinyxml2::XMLElement& model, bool fixed, SdfReport& report);

// Checks that the friction in <ode> is the same in all directions.
void check_friction(const tinyxml2::XMLElement& ode, SdfReport& report);

// Checks the type and the limits of a joint.
void check_joint(const tinyxml2::XMLElement& joint, SdfReport& report);

// Returns the direction from the scene to the lamp of a directional light, in world axes. Returns nullopt for
// other lights, and if the direction is not given in the world frame. The renderer needs a lamp at least 3
// degrees above the floor: for a lower lamp, the function also returns nullopt.
std::optional<Eigen::Vector3d> direction_to_lamp(const tinyxml2::XMLElement& light);

}  // namespace kaz::sim
