// Force readings: the external contact force on each link and the reaction force in each joint.
// SPDX-License-Identifier: Apache-2.0
//
// Readings are means over the last step, like the readings of a six-axis force-torque sensor in the link.
// Vectors are in the link's axes at the beginning of the step.
#pragma once

#include <Eigen/Geometry>

namespace kaz::sim {

// Sum of the contact forces that floor, objects and walls exert on one link. The sum includes neither
// contacts between two links of the robot nor impulses by World::push(). For a base that is fixed in the
// world, the sum is zero.
struct LinkForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // force in the link's axes, N
  // Moment about the link's origin, in the link's axes, Nm.
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double pressure = 0;  // sum of the normal forces, N; 0: no contact
  // Center of pressure in the link's frame, m. This point is the mean of the contact points, weighted by the
  // normal forces. For a flat sole on the floor, the center of pressure is the zero moment point (ZMP). The
  // contact moment about the center of pressure is parallel to the floor's normal.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();

  // Adds a contact point with the force `push` (N) and the moment `turn` (Nm, about the point `at`). All
  // arguments are in the world frame. `link` is the pose of the link, with rotation R and origin o.
  //
  //   f = R^T push, r = R^T (at - o);  force += f, moment += r x f + R^T turn, pressure += normal
  //
  // Each call of add() adds the product of `normal` and the vector r to `centre`. Later, finish() divides
  // `centre` by `pressure`.
  void add(const Eigen::Isometry3d& link, const Eigen::Vector3d& at, const Eigen::Vector3d& push,
           const Eigen::Vector3d& turn, double normal);
  // Call once after the last add().
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

// Force and moment that the parent link exerts on the child link of a joint. The moment is about the child
// link's origin. Force and moment are in the child link's axes. The loads of bearing, motor and joint stop
// are included. Therefore the moment along the joint axis is the joint torque.
struct JointLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // Nm
};

}  // namespace kaz::sim
