// Dynamics of a tree of rigid links in reduced coordinates.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/reduced/articulated_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kaz::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double dot(const Spatial& motion, const Spatial& force) {
  return motion.angular.dot(force.angular) + motion.linear.dot(force.linear);
}

Spatial operator+(const Spatial& a, const Spatial& b) {
  return {a.angular + b.angular, a.linear + b.linear};
}

Spatial scaled(const Spatial& a, double by) {
  return {a.angular * by, a.linear * by};
}

// Spatial cross product v x m for motions (Featherstone, 2.31).
Spatial carried(const Spatial& v, const Spatial& motion) {
  return {v.angular.cross(motion.angular),
          v.angular.cross(motion.linear) + v.linear.cross(motion.angular)};
}

// Spatial cross product v x* f for forces (Featherstone, 2.32).
Spatial carried_force(const Spatial& v, const Spatial& force) {
  return {v.angular.cross(force.angular) + v.linear.cross(force.linear),
          v.angular.cross(force.linear)};
}

// turn * rotation by `angle` about the unit `axis` (Rodrigues).
Matrix3d turned(const Matrix3d& turn, const Vector3d& axis, double angle) {
  const double s = std::sin(angle), c = std::cos(angle);
  const Vector3d t = (1 - c) * axis;
  Matrix3d r;
  r << c + t.x() * axis.x(), t.x() * axis.y() - s * axis.z(), t.x() * axis.z() + s * axis.y(),
      t.y() * axis.x() + s * axis.z(), c + t.y() * axis.y(), t.y() * axis.z() - s * axis.x(),
      t.z() * axis.x() - s * axis.y(), t.z() * axis.y() + s * axis.x(), c + t.z() * axis.z();
  return turn * r;
}

// Moment of inertia of a link without mass, kg m2. Two joints with such a link between them can become
// parallel, which would make the mass matrix singular. The rotor of a small servo has 5e-4 kg m2.
constexpr double kEmptyLinkInertia = 1e-7;

// Inertia of a point mass at r about the origin: m (r^2 I - r r^T), kg m2.
Matrix3d point_inertia(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

}  // namespace

ArticulatedTree::Scratch& ArticulatedTree::Scratch::of_this_thread(std::size_t links) {
  thread_local Scratch scratch;
  scratch.composite.resize(links);
  scratch.acceleration.resize(links);
  scratch.force.resize(links);
  return scratch;
}

ArticulatedTree::ArticulatedTree(const RobotModel& robot, const Eigen::Isometry3d& root, bool held)
    : root_at(root.translation()), root_turn(root.linear()) {
  root_turn.normalize();
  root_dofs_ = held || robot.fixed_base ? 0 : 6;
  dofs_ = root_dofs_ + static_cast<int>(robot.links.size()) - 1;
  Fixed fixed;
  fixed.dof_of_joint.resize(robot.joints.size());
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const RobotLink& from = robot.links[i];
    FixedLink link;
    link.parent = from.parent;
    link.mass = from.rigid.mass;
    link.own_com = from.rigid.com;
    link.own_inertia = from.rigid.inertia;
    if (from.parent >= 0 && link.mass == 0)
      link.own_inertia = kEmptyLinkInertia * Matrix3d::Identity();
    mass_ += link.mass;
    if (from.parent >= 0) {
      const RobotLink& parent = robot.links[index(from.parent)];
      const Eigen::Isometry3d in_parent = parent.at_zero.inverse() * from.at_zero;
      link.in_parent = in_parent.translation();
      link.at_zero = in_parent.linear();
      link.own_axis = from.at_zero.linear().transpose() * robot.joints[index(from.joint)].axis;
      link.pinion_m = robot.joints[index(from.joint)].pinion_m;
      link.dof = root_dofs_ + static_cast<int>(i) - 1;
      fixed.dof_of_joint[index(from.joint)] = link.dof;
      const FixedLink& carrier = fixed.links[index(from.parent)];
      link.span = {carrier.dof >= 0 ? carrier.span.first : link.dof, link.dof + 1};
    } else {
      link.span = {root_dofs_, root_dofs_};
    }
    fixed.links.push_back(link);
  }
  fixed_ = std::make_shared<const Fixed>(std::move(fixed));
  links_.resize(robot.links.size());
  angle.assign(robot.joints.size(), 0);
  velocity.assign(index(dofs_), 0);
  place();
  velocities();
}

// Poses from root to leaves, R_i = R_parent R_0 R(axis, angle). A prismatic joint shifts the origin by
// pinion_m * angle. Inertias about P: first moment m c,
// second moment R I R^T + m (c^2 1 - c c^T).
void ArticulatedTree::place() {
  whole_ = {};
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const FixedLink& own = fixed(i);
    Link& link = links_[i];
    if (own.parent < 0) {
      link.axes = root_turn.toRotationMatrix();
      link.origin.setZero();
    } else {
      const Link& parent = links_[index(own.parent)];
      const double q = angle[index(own.dof - root_dofs_)];
      link.origin = parent.origin + parent.axes * own.in_parent;
      if (own.pinion_m > 0) {
        link.axes = parent.axes * own.at_zero;
        link.motion = {Vector3d::Zero(), own.pinion_m * (link.axes * own.own_axis)};
        link.origin += q * link.motion.linear;
      } else {
        link.axes = turned(parent.axes * own.at_zero, own.own_axis, q);
        link.motion.angular = link.axes * own.own_axis;
        link.motion.linear = link.origin.cross(link.motion.angular);
      }
    }
    link.com = link.origin + link.axes * own.own_com;
    link.inertia.mass = own.mass;
    link.inertia.first = own.mass * link.com;
    link.inertia.second =
        link.axes * own.own_inertia * link.axes.transpose() + point_inertia(own.mass, link.com);
    whole_.mass += own.mass;
    whole_.first += link.inertia.first;
    whole_.second += link.inertia.second;
  }
}

// Twists from root to leaves: v_i = v_parent + S_i dq_i.
void ArticulatedTree::twists(const std::vector<double>& v) {
  Link& root = links_.front();
  if (root_dofs_ == 6) {
    root.twist.angular = {v[0], v[1], v[2]};
    root.twist.linear = {v[3], v[4], v[5]};
  }
  for (std::size_t i = 1; i < links_.size(); ++i) {
    const FixedLink& own = fixed(i);
    Link& link = links_[i];
    link.twist = links_[index(own.parent)].twist + scaled(link.motion, v[index(own.dof)]);
  }
}

Vector3d ArticulatedTree::velocity_at(int link, const Vector3d& point) const {
  const Spatial& twist = links_[index(link)].twist;
  return twist.linear + twist.angular.cross(point - root_at);
}

Vector3d ArticulatedTree::mass_centre() const {
  return root_at + whole_.first / whole_.mass;
}

ArticulatedTree::Momentum ArticulatedTree::momentum() {
  velocities();
  Spatial sum;
  for (const Link& link : links_) sum = sum + link.inertia * link.twist;
  return {sum.linear, sum.angular - (whole_.first / whole_.mass).cross(sum.linear)};
}

// Rigid velocity of the whole tree that makes up the difference in momentum: w = I_c^-1 dL about the centre
// of mass c, v_P = dp / m - w x c.
void ArticulatedTree::set_momentum(const Momentum& to) {
  if (root_dofs_ != 6) return;
  const Momentum now = momentum();
  const Vector3d centre = whole_.first / whole_.mass;
  const Matrix3d about_centre = whole_.second - point_inertia(whole_.mass, centre);
  const Vector3d turn = about_centre.inverse() * (to.angular - now.angular);
  const Vector3d shift = (to.linear - now.linear) / whole_.mass - turn.cross(centre);
  for (int k = 0; k < 3; ++k) {
    velocity[index(k)] += turn[k];
    velocity[index(k + 3)] += shift[k];
  }
  velocities();
}

double ArticulatedTree::kinetic_energy() {
  velocities();
  double twice = 0;
  for (const Link& link : links_) twice += dot(link.twist, link.inertia * link.twist);
  return twice / 2;
}

// Composite inertia of each link with all its descendants, from leaves to root.
std::span<const ArticulatedTree::Inertia> ArticulatedTree::composite() const {
  std::vector<Inertia>& sums = Scratch::of_this_thread(links_.size()).composite;
  for (std::size_t i = 0; i < links_.size(); ++i) sums[i] = links_[i].inertia;
  for (std::size_t i = links_.size(); i-- > 1;) {
    Inertia& parent = sums[index(fixed(i).parent)];
    parent.mass += sums[i].mass;
    parent.first += sums[i].first;
    parent.second += sums[i].second;
  }
  return sums;
}

// M_ij = S_j . (I_i^composite S_i) for ancestors j of i; the columns of the root are that force itself.
void ArticulatedTree::write_mass_row(std::size_t number, const Inertia& composite,
                                     double* m) const {
  const Link& link = links_[number];
  const Spatial force = composite * link.motion;
  m[fixed(number).dof] = dot(link.motion, force);
  for (int up = fixed(number).parent; up > 0; up = fixed(index(up)).parent)
    m[fixed(index(up)).dof] = dot(links_[index(up)].motion, force);
  if (root_dofs_ == 0) return;
  for (int k = 0; k < 3; ++k) {
    m[k] = force.angular[k];
    m[k + 3] = force.linear[k];
  }
}

// Rows of the root: second moment, and m v - (m c) x w for the linear part; lower triangle.
void ArticulatedTree::write_root_row(int i, double* m) const {
  if (i < 3) {
    for (int k = 0; k <= i; ++k) m[k] = whole_.second(i, k);
    return;
  }
  const Vector3d axis = Vector3d::Unit(i - 3);
  const Vector3d turning = whole_.first.cross(axis);
  for (int k = 0; k < 3; ++k) m[k] = turning[k];
  for (int k = 3; k < i; ++k) m[k] = 0;
  m[i] = whole_.mass;
}

// Force on each link by itself: f = I a + v x* (I v), with accelerations from root to leaves. Gravity enters
// as an acceleration -g of the root.
std::span<Spatial> ArticulatedTree::inertial_forces(const std::vector<double>& v, const double* a,
                                                    const Vector3d& gravity) {
  twists(v);
  auto& [unused, acceleration, force] = Scratch::of_this_thread(links_.size());
  const Spatial& root = links_.front().twist;
  // Spatial acceleration = acceleration of the body-fixed point at P minus w x v (Featherstone, 2.46).
  acceleration[0] = {Vector3d::Zero(), -gravity - root.angular.cross(root.linear)};
  if (a != nullptr && root_dofs_ == 6)
    acceleration[0] = acceleration[0] + Spatial{{a[0], a[1], a[2]}, {a[3], a[4], a[5]}};
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    if (i > 0) {
      const FixedLink& own = fixed(i);
      acceleration[i] = acceleration[index(own.parent)] +
                        carried(link.twist, scaled(link.motion, v[index(own.dof)]));
      if (a != nullptr) acceleration[i] = acceleration[i] + scaled(link.motion, a[index(own.dof)]);
    }
    force[i] =
        link.inertia * acceleration[i] + carried_force(link.twist, link.inertia * link.twist);
  }
  return force;
}

void ArticulatedTree::bias(const std::vector<double>& v, const Vector3d& gravity,
                           std::vector<double>& c) {
  const std::span<Spatial> force = inertial_forces(v, nullptr, gravity);
  for (std::size_t i = links_.size(); i-- > 1;) {
    c[index(fixed(i).dof)] = dot(links_[i].motion, force[i]);
    Spatial& parent = force[index(fixed(i).parent)];
    parent = parent + force[i];
  }
  if (root_dofs_ == 0) return;
  for (int k = 0; k < 3; ++k) {
    c[index(k)] = force[0].angular[k];
    c[index(k + 3)] = force[0].linear[k];
  }
}

void ArticulatedTree::joint_forces(const std::vector<double>& v, const std::vector<double>& a,
                                   const Vector3d& gravity, std::vector<Spatial>& forces) {
  const std::span<const Spatial> inertial = inertial_forces(v, a.data(), gravity);
  for (std::size_t i = 0; i < links_.size(); ++i) forces[i] = inertial[i] + scaled(forces[i], -1);
  for (std::size_t i = links_.size(); i-- > 1;) {
    Spatial& parent = forces[index(fixed(i).parent)];
    parent = parent + forces[i];
  }
}

void ArticulatedTree::add_force(int link, const Vector3d& point, const Vector3d& force,
                                double* out) const {
  const Spatial wrench{(point - root_at).cross(force), force};
  for (int i = link; i > 0; i = fixed(index(i)).parent)
    out[fixed(index(i)).dof] += dot(links_[index(i)].motion, wrench);
  if (root_dofs_ == 0) return;
  for (int k = 0; k < 3; ++k) {
    out[k] += wrench.angular[k];
    out[k + 3] += wrench.linear[k];
  }
}

void ArticulatedTree::add_motions(int link, double sign, int first, double* columns) const {
  for (int i = link; i > 0; i = fixed(index(i)).parent) {
    const Spatial& motion = links_[index(i)].motion;
    double* column = columns + 6 * (fixed(index(i)).dof - first);
    for (int k = 0; k < 3; ++k) {
      column[k] += sign * motion.angular[k];
      column[k + 3] += sign * motion.linear[k];
    }
  }
}

}  // namespace kaz::sim
