// Robot model from an MJCF file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "sim/body/description/robot_model.h"
#include "sim/body/description/xml_file.h"

namespace kaz::sim {

inline constexpr const char* kMjcfRoot = "mujoco";  // root element

// Reads a robot from a file with the root <mujoco>. libmujoco compiles it.
//
// The robot is the tree of bodies with a hinge. If the tree has a free joint, the body with this joint is
// the root. Otherwise the robot is fixed, and its root is the link `world`. This link also has all fixed
// bodies and shapes of the world, except planes. Bodies without a joint are merged into the link that carries
// them. Bodies and named sites are frames.
//
// The frame of a link is on its joint's axis. If a hinge is not at the origin of its body, the link is named
// BODY_at_JOINT, and RobotModel::frames has the frame of the body.
//
// Errors: Fault::usage with all objections of one stage (elements, libmujoco, robot), with file and line.
Result<RobotModel> read_mjcf(const XmlFile& file, const ReadOptions& options);

}  // namespace kaz::sim
