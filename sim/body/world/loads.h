// Force readings: external contact force on each link, reaction force in each joint.
// SPDX-License-Identifier: Apache-2.0
//
// Means over the last step, in the link's axes at its beginning, as a six-axis force-torque sensor in the
// link would measure.
#pragma once

#include <Eigen/Geometry>

namespace kaz::sim {

// Sum of all contacts of one link with anything but the robot: floor, objects, walls. Zero for a fixed base.
// World::push() is not included.
struct LinkForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N, link's axes
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // Nm, about the link's origin, link's axes
  double pressure = 0;  // N, sum of the points' normal forces; 0: no contact
  // Centre of pressure: mean of the contact points weighted by their normal forces, m, link's frame. For a
  // flat sole on the floor, the point about which the contact moment is parallel to the floor's normal (ZMP).
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();

  // Adds a contact point: f += R^T push, m += r x f + R^T turn, with r = R^T (at - origin). Until finish(),
  // `centre` holds sum normal r. `link`: world pose of the link; the other arguments in world axes, `turn`:
  // moment about the point, Nm.
  void add(const Eigen::Isometry3d& link, const Eigen::Vector3d& at, const Eigen::Vector3d& push,
           const Eigen::Vector3d& turn, double normal);
  void finish() {
    if (pressure > 0) centre /= pressure;
  }

  template <class A>
  void transfer(A& a) {
    a(pressure);
    for (Eigen::Vector3d* v : {&force, &moment, &centre})
      for (int k = 0; k < 3; ++k) a((*v)[k]);
  }
};

// Reaction of the parent on the child link: bearing, motor and stop together, so the component along the axis
// is the joint torque. At the joint's origin (the child link's origin), in the child's axes.
struct JointLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // Nm
};

}  // namespace kaz::sim
