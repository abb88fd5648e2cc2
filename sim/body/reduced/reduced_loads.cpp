// World in reduced coordinates: contact forces on links and loads in joints, from the solution of a step.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/body/reduced/reduced_world.h"

namespace kaz::sim {

using Eigen::Vector3d;

// Contact forces = impulses / h, at the poses of the beginning of the step. To be called after solve() and
// before advance().
void ReducedWorld::measure_forces(Work& work) {
  std::ranges::fill(link_forces_, LinkForce{});
  if (watch_loads_) std::ranges::fill(work.outer, Spatial{});
  for (std::size_t i = 0; i < work.pushes.size(); ++i) {
    const Touch& touch = work.contacts.touches()[work.pushes[i].touch];
    const bool a = of_robot(touch.body_a), b = of_robot(touch.body_b);
    if (!a && !b) continue;
    const VelocitySolver::Impulse l = work.impulse(i) / step_s_;
    const Vector3d force = work.pushes[i].basis * l.head<3>();
    const Vector3d moment = work.pushes[i].basis * Vector3d(l[5], l[3], l[4]);
    if (a != b) {
      const int link = a ? touch.body_a : touch.body_b;
      const double sign = a ? 1 : -1;
      link_forces_[static_cast<std::size_t>(link)].add(moving_pose(link), touch.at, sign * force,
                                                       sign * moment, l[0]);
    }
    if (!watch_loads_) continue;
    const auto push = [&](int link, double sign) {
      Spatial& outer = work.outer[static_cast<std::size_t>(link)];
      outer.linear += sign * force;
      outer.angular += sign * ((touch.at - tree_.root_at).cross(force) + moment);
    };
    if (a) push(touch.body_a, 1);
    if (b) push(touch.body_b, -1);
  }
  for (LinkForce& force : link_forces_) force.finish();
  joint_loads_.resize(watch_loads_ ? joint_states_.size() : 0);
  if (watch_loads_) measure_loads(work);
}

// Joint loads by inverse dynamics: accelerations (v_new - v) / h, bias at the midpoint velocity as in the
// solve, external forces from contacts and pushes. At the joint's origin in the child link's axes.
void ReducedWorld::measure_loads(Work& work) {
  for (const HandPush& push : hand_pushes_) {
    const int link = static_cast<int>(push.link);
    const Vector3d force = push.impulse / step_s_;
    Spatial& outer = work.outer[push.link];
    outer.linear += force;
    outer.angular += (tree_.com(link) - tree_.root_at).cross(force);
  }
  const std::vector<double>& before = work.struck.empty() ? tree_.velocity : work.unstruck;
  for (std::size_t i = 0; i < work.acceleration.size(); ++i)
    work.acceleration[i] = (work.velocity[i] - before[i]) / step_s_;
  tree_.joint_forces(work.halfway, work.acceleration, gravity_, work.outer);
  for (std::size_t i = 0; i < joint_loads_.size(); ++i) {
    const int link = tree_.link_of_dof(layout_->joints[i].dof);
    const auto& [moment, force] = work.outer[static_cast<std::size_t>(link)];
    const Eigen::Matrix3d to_link = tree_.axes(link).transpose();
    const Vector3d arm = tree_.origin(link) - tree_.root_at;
    joint_loads_[i] = {to_link * force, to_link * (moment - arm.cross(force))};
  }
}

}  // namespace kaz::sim
