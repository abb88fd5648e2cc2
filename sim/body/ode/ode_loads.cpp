// World on ODE: forces on links and in joints, from ODE's joint feedback.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/body/ode/ode_world.h"

namespace kaz::sim {

using Eigen::Vector3d;

void OdeWorld::watch_loads(bool on) {
  StagedWorld::watch_loads(on);
  for (Joint& joint : ode_joints_) dJointSetFeedback(joint.hinge, on ? &joint.bearing : nullptr);
}

void OdeWorld::keep_frames() {
  frames_before_.resize(robot_links_);
  for (std::size_t i = 0; i < robot_links_; ++i) frames_before_[i] = body_pose(static_cast<int>(i));
}

// Sums contact forces per link of the robot. ODE's feedback of body 1 and 2 is the force and the moment about
// that body's centre of mass c, world frame; at the contact point p the moment is M_p = M_c - (p - c) x F.
void OdeWorld::measure_forces() {
  std::ranges::fill(link_forces_, LinkForce{});
  for (const Watched& row : watched_) {
    const Touch& touch = row.touch;
    const auto of_robot = [this](int body) {
      return body >= 0 && static_cast<std::size_t>(body) < robot_links_;
    };
    const bool a = of_robot(touch.body_a), b = of_robot(touch.body_b);
    if (a == b) continue;
    const auto link = static_cast<std::size_t>(a ? touch.body_a : touch.body_b);
    // If a is static, ODE's first body is b.
    const bool first = a || touch.body_a < 0;
    const Vector3d force = to_eigen(first ? row.feedback.f1 : row.feedback.f2);
    const Vector3d about_com = to_eigen(first ? row.feedback.t1 : row.feedback.t2);
    const Eigen::Isometry3d& frame = frames_before_[link];
    const Vector3d com = frame * bodies()[link].rigid.com;
    link_forces_[link].add(frame, touch.at, force, about_com - (touch.at - com).cross(force),
                           (a ? 1 : -1) * touch.normal.dot(force));
  }
  for (LinkForce& force : link_forces_) force.finish();
  measure_loads();
}

// Force and moment that each joint transmits to its child, in the child's frame, about the link's origin:
// hinge and motor together, M_o = M_c + c x F with the centre of mass c.
void OdeWorld::measure_loads() {
  joint_loads_.resize(watch_loads_ ? ode_joints_.size() : 0);
  for (std::size_t i = 0; i < joint_loads_.size(); ++i) {
    const Joint& joint = ode_joints_[i];
    const auto link = static_cast<std::size_t>(joint.link);
    const Eigen::Matrix3d to_link = frames_before_[link].linear().transpose();
    const Vector3d force = to_link * to_eigen(joint.bearing.f1);
    const Vector3d bearing = to_link * to_eigen(joint.bearing.t1);
    Vector3d motor = to_link * to_eigen(joint.feedback.t1);
    if (joint.pressing) motor = joint.axis * *joint.pressing;
    const Vector3d moment = bearing + motor;
    joint_loads_[i] = {force, moment + bodies()[link].rigid.com.cross(force)};
  }
}

}  // namespace kaz::sim
