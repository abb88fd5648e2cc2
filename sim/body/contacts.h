// Finds what touches what, and makes the solver's contact rows of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/body/ode_handles.h"
#include "sim/body/rigid_link.h"
#include "sim/body/robot_model.h"

namespace kaz::sim {

class Contacts {
 public:
  Contacts(dWorldID world, const RobotModel& robot);

  // Shapes of one link. `body` null: fixed in the world, then `pose` is the link's; else shapes
  // hang on the body, whose frame has the link's axes and its origin at `com`.
  void add_robot_link(const RigidLink& link, int robot_link, dBodyID body,
                      const Eigen::Isometry3d& pose);
  void add_object(const RigidLink& link, dBodyID body, const Eigen::Isometry3d& pose);

  // Replaces the rows of the last step.
  void update();

 private:
  struct Geom {
    Surface surface;
    int robot_link = -1;  // -1: no part of the robot
  };

  void add(const RigidLink& link, int robot_link, dBodyID body, const Eigen::Isometry3d& pose,
           dSpaceID space);
  static void near_callback(void* self, dGeomID a, dGeomID b);
  void touch(dGeomID a, dGeomID b);
  const Geom& of(dGeomID geom) const;

  dWorldID world_;
  // Three plain spaces: for so few shapes the pairwise test of boxes is the fastest there is.
  OdeSpaceHandle robot_space_, fixed_space_, object_space_;
  OdeJointGroupHandle rows_;
  std::vector<Geom> geoms_;
  // exempt_[a * links + b]: links so near in the tree that their shapes may overlap at the joints.
  std::vector<char> exempt_;
  std::size_t robot_links_;
};

}  // namespace kaz::sim
