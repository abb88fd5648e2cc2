// Friction of a URDF's links, and PyBullet's <contact>.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/body/description/urdf_check.h"
#include "sim/body/description/urdf_joints.h"

namespace kaz::sim {

// Fills Urdf::friction from <gazebo reference="LINK"><mu1>, as Gazebo reads it, and from PyBullet's
// <contact><lateral_friction>; fills Urdf::inertia_scales from <contact><inertia_scaling>. Calls `object` for
// each error: an unknown link, a value that is not a number above or equal to 0, or two coefficients that
// differ. Calls `note` for other elements of <gazebo>. If `body` is false, only notes are made.
void read_surfaces(Urdf& urdf, bool body, const UrdfRemark& object, const UrdfRemark& note);

}  // namespace kaz::sim
