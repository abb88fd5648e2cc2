// Joints of an SDF world: fixed joints merge bodies, the others become WorldJoint.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <sdf/sdf.hh>

#include "shared/base/result.hpp"
#include "sim/body/description/world_model.h"

namespace kaz::sim {

// A joint of libsdformat, and the model that contains it.
struct SdfJoint {
  const sdf::Joint* joint = nullptr;
  std::string model;  // name with the names of its parents, "outer::inner"
  Eigen::Isometry3d model_pose = Eigen::Isometry3d::Identity();  // in the world
};

// Adds the joints to `world`. `body_of`: index into WorldModel::bodies by "model::link". Bodies that fixed
// joints connect are merged into the first of them; bodies fixed to the world or to a fixed body are fixed.
// Joints between two fixed bodies, and within one merged body, are left out. The child of each WorldJoint can
// move; its parent may be fixed. Fails if a joint has no valid
// link or axis.
Result<void> add_joints(const std::vector<SdfJoint>& joints, std::map<std::string, int> body_of,
                        WorldModel& world);

}  // namespace kaz::sim
