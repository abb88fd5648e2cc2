// World in reduced coordinates: rows of the passive joints between free bodies.
// SPDX-License-Identifier: Apache-2.0
//
// The joint's error at the end of the step is linear in the velocities:
//
//   g(q + h v) = g(q + h v_old) + h J (v - v_old)
//
// The rows make it zero. The bodies' velocities are those between two steps, as in the SHAKE algorithm
// (Ryckaert, Ciccotti & Berendsen, J. Comput. Phys. 23, 1977). Rows that only made J v zero would brake: the
// velocity of the last step is no longer tangential, and its normal part would be lost in each step.
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/body/contact/contact_surface.h"
#include "sim/body/reduced/reduced_world.h"

namespace kaz::sim {
namespace {

using Eigen::Vector3d;

constexpr double kPassiveStopWatch = 0.02;  // rad or m, distance from which a stop gets a row

}  // namespace

void ReducedWorld::add_passive_joints() {
  auto layout = std::make_shared<Layout>(*layout_);
  const auto index = [this](int body) {
    return body < 0 ? -1 : body - static_cast<int>(robot_links_);
  };
  for (std::size_t i = robot_links_; i < bodies().size(); ++i)
    layout->jointed.push_back(model_->has_joint(static_cast<int>(i)));
  for (const WorldJoint& from : model_->joints) {
    const int parent = index(from.parent), child = index(from.child);
    PassiveJoint joint(from, object_or_null(parent), object_or_null(child));
    joint.parent = parent;
    joint.child = child;
    layout->passive.push_back(joint);
  }
  passive_angle_.assign(layout->passive.size(), 0.0);
  layout_ = std::move(layout);
}

void ReducedWorld::make_passive_rows(Work& work) const {
  for (std::size_t i = 0; i < layout_->passive.size(); ++i) {
    const PassiveJoint& joint = layout_->passive[i];
    const JointFrame parent = frame_on(object_or_null(joint.parent), joint.in_parent);
    const JointFrame child = frame_on(object_or_null(joint.child), joint.in_child);
    const auto ahead = [this](int number, const JointFrame& frame) {
      if (number < 0) return frame;
      FreeBody body = objects_[static_cast<std::size_t>(number)];
      body.advance(body.velocity, body.angular_velocity(), false, step_s_);
      return frame_on(&body, frame);
    };
    const PassiveJoint::Gap gap =
        PassiveJoint::gap(ahead(joint.parent, joint.in_parent), ahead(joint.child, joint.in_child));
    for (int k = 0; k < 3; ++k) {
      const Vector3d along = parent.basis.col(k);
      const auto hold = [&](bool turns, double error) {
        VelocitySolver::Tie tie = tie_of(work, joint, child.at, along, turns);
        tie.target = tie_velocity(work, tie) - error / step_s_;
        work.solver.add_tie(tie);
      };
      if (joint.holds_shift(k)) hold(false, gap.shift[k]);
      if (joint.holds_turn(k)) hold(true, gap.turn[k]);
    }
    make_passive_axis_rows(work, i, child.at, parent.basis.col(2));
  }
}

// Row of the child's velocity relative to the parent's along a unit vector, at the point `at`.
VelocitySolver::Tie ReducedWorld::tie_of(const Work& work, const PassiveJoint& joint,
                                         const Vector3d& at, const Vector3d& along,
                                         bool turns) const {
  VelocitySolver::Tie tie;
  std::size_t range = 0;
  double* entry = tie.entry.data();
  for (const auto& [number, sign] : {std::pair{joint.parent, -1.0}, {joint.child, 1.0}}) {
    if (number < 0) continue;
    const FreeBody& body = objects_[static_cast<std::size_t>(number)];
    const Vector3d angular = turns ? along : Vector3d((at - body.com).cross(along));
    for (int k = 0; k < 3; ++k) {
      entry[k] = sign * angular[k];
      entry[k + 3] = turns ? 0 : sign * along[k];
    }
    tie.first[range] = work.coordinate_of[static_cast<std::size_t>(number)];
    tie.length[range] = 6;
    ++range;
    entry += 6;
  }
  return tie;
}

double ReducedWorld::tie_velocity(const Work& work, const VelocitySolver::Tie& tie) {
  double sum = 0;
  const double* entry = tie.entry.data();
  for (std::size_t range = 0; range < 2; ++range) {
    for (int k = 0; k < tie.length[range]; ++k)
      sum += *entry++ * work.velocity[static_cast<std::size_t>(tie.first[range] + k)];
  }
  return sum;
}

// Stops, damping and friction along or about the axis of a joint.
void ReducedWorld::make_passive_axis_rows(Work& work, std::size_t number, const Vector3d& at,
                                          const Vector3d& axis) const {
  const PassiveJoint& joint = layout_->passive[number];
  if (joint.kind == WorldJoint::Kind::ball) return;
  const VelocitySolver::Tie free =
      tie_of(work, joint, at, axis, joint.kind == WorldJoint::Kind::revolute);
  const double watch = kPassiveStopWatch + step_s_ * std::abs(tie_velocity(work, free));
  const auto stop = [&](double gap, double sign) {  // negative: beyond the stop
    if (!(gap <= watch)) return;
    VelocitySolver::Tie tie = free;
    for (double& entry : tie.entry) entry *= sign;
    tie.target = -(gap > 0 ? 1 : erp_for(step_s_, kStopErp)) * gap / step_s_;
    tie.min = 0;
    work.solver.add_tie(tie);
  };
  stop(passive_angle_[number] - joint.lower, 1);
  stop(joint.upper - passive_angle_[number], -1);
  if (joint.damping > 0) {
    VelocitySolver::Tie tie = free;
    tie.softness = 1 / (step_s_ * joint.damping);
    work.solver.add_tie(tie);
  }
  if (joint.friction > 0) {
    VelocitySolver::Tie tie = free;
    tie.max = step_s_ * joint.friction;
    tie.min = -tie.max;
    work.solver.add_tie(tie);
  }
}

void ReducedWorld::read_passive_joints() {
  for (std::size_t i = 0; i < layout_->passive.size(); ++i) {
    const PassiveJoint& joint = layout_->passive[i];
    const PassiveJoint::Gap gap =
        PassiveJoint::gap(frame_on(object_or_null(joint.parent), joint.in_parent),
                          frame_on(object_or_null(joint.child), joint.in_child));
    passive_angle_[i] = joint.coordinate(gap, passive_angle_[i]);
  }
}

}  // namespace kaz::sim
