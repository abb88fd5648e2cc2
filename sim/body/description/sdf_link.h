// Converts a link of libsdformat to a rigid link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <sdf/sdf.hh>

#include "shared/base/result.hpp"
#include "sim/body/description/reading.h"
#include "sim/body/description/rigid_link.h"

namespace kaz::sim {

Eigen::Vector3d from_sdf(const ignition::math::Vector3d& v);
Eigen::Isometry3d from_sdf(const ignition::math::Pose3d& p);

// Returns a pose in the frame of the element that contains it. `scope`: name of that frame for libsdformat.
Eigen::Isometry3d pose_in(const sdf::SemanticPose& pose, const std::string& scope);

// Returns the `count` numbers in an attribute of one of Kaz's own elements, which check_sdf() accepted.
std::vector<double> own_numbers(const sdf::ElementPtr& element, const char* attribute,
                                std::size_t count);

// Returns the mass, the collision shapes and the visuals of a link. `name`: RigidLink::name. Fails (usage) if
// the mesh of a collision cannot be read.
Result<RigidLink> rigid_of(const sdf::Link& link, const std::string& name,
                           const ReadOptions& options);

}  // namespace kaz::sim
