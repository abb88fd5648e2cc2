// What sensors of force would measure: what pushes each link from outside, what each joint bears.
// SPDX-License-Identifier: Apache-2.0
//
// Means over the last step, in the axes which the link had at its beginning: nothing but those of a
// six-axis sensor built into the link.
#pragma once

#include <Eigen/Geometry>

namespace kaz::sim {

// What everything that is not the robot does to one of its links: floor, objects, walls. A link that
// touches only the robot itself has none; nor has a base that never moves.
// World::push() is no touch.
struct LinkForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N, link's axes
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // Nm, about the link's origin, link's axes
  double pressure = 0;  // N, sum of the points' normal forces; 0: nothing is touched
  // Centre of pressure: mean place of the points of contact by their normal forces, m, in the link's
  // frame. Of a sole flat on the floor it is the point where friction has no moment but about the
  // floor's normal.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();

  // While it is summed `centre` is the first moment of pressure. `link`: its frame in the world;
  // the rest in world axes, `moment` of a point about itself.
  void add(const Eigen::Isometry3d& link, const Eigen::Vector3d& at, const Eigen::Vector3d& push,
           const Eigen::Vector3d& turn, double normal) {
    const Eigen::Matrix3d to_link = link.linear().transpose();
    const Eigen::Vector3d arm = to_link * (at - link.translation());
    const Eigen::Vector3d f = to_link * push;
    force += f;
    moment += arm.cross(f) + to_link * turn;
    pressure += normal;
    centre += normal * arm;
  }
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

// What the parent's side of a joint does to the child's: bearing, motor and stop together, so that
// along the axis it is the torque that turns the joint. At the joint's origin, which is the child
// link's, in the child's axes.
struct JointLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // Nm
};

}  // namespace kaz::sim
