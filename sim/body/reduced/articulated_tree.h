// Dynamics of a tree of rigid links in reduced coordinates: one coordinate per joint, and six for a floating
// base. By construction, joints cannot drift apart.
// SPDX-License-Identifier: Apache-2.0
//
// Source: R. Featherstone, "Rigid Body Dynamics Algorithms" (2008), sections 6.2 (composite-rigid-body
// algorithm) and 5.3 (recursive Newton-Euler algorithm).
//
// All spatial quantities are in world axes about the same point P, the present origin of the root link.
// Therefore inertias and forces of different links can be added without transforms. For a floating base, the
// velocity vector v begins with the root's angular velocity (rad/s) and the velocity of P (m/s), in world
// axes. After these six coordinates, v contains the joint velocities (rad/s) in the order of the links,
// parents first.
//
//   M(q) dv/dt + c(q, v) = tau
//
// The class allocates no memory after the first step in a thread. All sums have a fixed order, so equal
// inputs produce bit-identical results. Copies of a tree share constant data.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/body/description/robot_model.h"

namespace kaz::sim {

// Spatial vector about P. For a motion, `angular` is the angular velocity, and `linear` is the velocity of
// the body's point at P. For a force, `angular` is the moment about P, and `linear` is the force.
struct Spatial {
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
};

class ArticulatedTree {
 public:
  // `root`: world pose of the root link. If `held` is true, the base is fixed even if the model's base is
  // floating.
  ArticulatedTree(const RobotModel& robot, const Eigen::Isometry3d& root, bool held);

  int dofs() const { return dofs_; }
  int root_dofs() const { return root_dofs_; }
  int dof_of_joint(int joint) const { return fixed_->dof_of_joint[index(joint)]; }
  std::size_t index_of_dof(int dof) const { return index(dof - root_dofs_); }  // in `angle`
  int link_of_dof(int dof) const { return dof - root_dofs_ + 1; }

  // State of the tree. `angle` (rad) has one element for each joint. `velocity` is the vector v of the
  // comment at the top of this file.
  Eigen::Vector3d root_at;  // position of the root link's origin (P), world frame, m
  Eigen::Quaterniond root_turn;
  std::vector<double> angle;  // indexed by index_of_dof()
  std::vector<double> velocity;

  // Computes poses, joint axes and inertias (forward kinematics). Call after each change of the root's pose
  // or of `angle`.
  void place();
  const Eigen::Matrix3d& axes(int link) const { return links_[index(link)].axes; }
  Eigen::Vector3d origin(int link) const { return root_at + links_[index(link)].origin; }
  Eigen::Vector3d com(int link) const { return root_at + links_[index(link)].com; }
  // Returns the velocity (m/s, world axes) of a point that is fixed to a link. `point` is in the world frame,
  // m. The result is valid after a call of velocities().
  Eigen::Vector3d velocity_at(int link, const Eigen::Vector3d& point) const;
  Eigen::Vector3d angular_velocity(int link) const { return links_[index(link)].twist.angular; }
  // Computes the twist (spatial velocity) of each link from `velocity`.
  void velocities() { twists(velocity); }

  // Linear momentum of the whole tree (kg m/s), and angular momentum about the tree's center of mass
  // (kg m2/s).
  struct Momentum {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
  };
  Momentum momentum();
  // Changes the velocity of a floating base so that the tree has the momentum `to`. Joint velocities stay
  // unchanged. The function has no effect if the base is fixed.
  void set_momentum(const Momentum& to);
  Eigen::Vector3d mass_centre() const;  // center of mass of the whole tree, world frame, m
  double mass() const { return mass_; }
  double kinetic_energy();  // J

  // Computes M for the present pose (composite-rigid-body algorithm). `row(i)` must return a pointer to row
  // i. In each row, only the diagonal and the columns of the ancestor joints are written.
  template <class Row>
  void mass_matrix(Row row) const {
    const std::span<const Inertia> composites = composite();
    for (std::size_t i = 1; i < links_.size(); ++i)
      write_mass_row(i, composites[i], row(fixed(i).dof));
    for (int i = 0; i < root_dofs_; ++i) write_root_row(i, row(i));
  }
  // Computes the bias c(q, v) with the recursive Newton-Euler algorithm. The bias c is the generalized force
  // tau at which no coordinate accelerates. Elements for rotations are in N m, elements for translations in
  // N. `c` must have dofs() entries.
  void bias(const std::vector<double>& velocity, const Eigen::Vector3d& gravity,
            std::vector<double>& c);

  // Computes the spatial force transmitted to each link through its parent joint, for a motion with the given
  // velocity and acceleration (recursive Newton-Euler). `forces` has one entry per link. On entry, `forces`
  // contains the external forces on the links, without gravity. On return, `forces` contains the forces
  // transmitted through the joints. On return, the entry of the root is the force that must act on the base
  // to cause this motion.
  void joint_forces(const std::vector<double>& velocity, const std::vector<double>& acceleration,
                    const Eigen::Vector3d& gravity, std::vector<Spatial>& forces);

  // Range of coordinates that includes the joint of a link and the joints of all its ancestors, but not the
  // root's six coordinates.
  struct Span {
    int first = 0, end = 0;
  };
  Span span_of_link(int link) const { return fixed(index(link)).span; }
  // Returns the coordinate of the parent link's joint. -1: the parent link is the root.
  int carrier_of_dof(int dof) const {
    return fixed(index(fixed(index(dof - root_dofs_ + 1)).parent)).dof;
  }
  // Computes out += transpose(J) * force. J is the Jacobian of `point`, a point of the link. `force` acts at
  // this point and is a force in N or an impulse in N s. `force` and `point` are in the world frame. `out`
  // has dofs() entries.
  void add_force(int link, const Eigen::Vector3d& point, const Eigen::Vector3d& force,
                 double* out) const;
  // Computes columns += sign * J. J is the link's geometric Jacobian about P. Each column has six numbers
  // (angular, linear). The column of joint coordinate i begins at columns + 6 (i - first). The columns of the
  // root's six coordinates are not written.
  void add_motions(int link, double sign, int first, double* columns) const;

 private:
  struct Inertia {  // spatial inertia about P
    double mass = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();  // mass times center of mass
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    Spatial operator*(const Spatial& motion) const {
      return {second * motion.angular + first.cross(motion.linear),
              mass * motion.linear - first.cross(motion.angular)};
    }
  };
  // Constant data of a link.
  struct FixedLink {
    int parent = -1, dof = -1;
    Span span;
    // Origin of the link in the parent's axes.
    Eigen::Vector3d in_parent = Eigen::Vector3d::Zero();
    // The link's axes at angle 0, in the parent's axes.
    Eigen::Matrix3d at_zero = Eigen::Matrix3d::Identity();
    Eigen::Vector3d own_axis = Eigen::Vector3d::UnitX();  // joint axis in the link's own axes
    double pinion_m = 0;  // RobotJoint::pinion_m
    double mass = 0;
    // Center of mass in the link's own axes.
    Eigen::Vector3d own_com = Eigen::Vector3d::Zero();
    // Inertia tensor about the center of mass, in the link's own axes.
    Eigen::Matrix3d own_inertia = Eigen::Matrix3d::Identity();
  };
  struct Fixed {
    std::vector<FixedLink> links;
    std::vector<int> dof_of_joint;
  };
  // Data of a link for the present pose. Vectors to points begin at P.
  struct Link {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(), com = Eigen::Vector3d::Zero();
    // Motion subspace S: spatial velocity of the link relative to the parent link if the joint turns at 1
    // rad/s.
    Spatial motion;
    Inertia inertia;
    Spatial twist;
  };
  // Working memory of one computation. The vectors are indexed by link. Each thread has one Scratch object
  // for all trees.
  struct Scratch {
    std::vector<Inertia> composite;
    std::vector<Spatial> acceleration, force;
    static Scratch& of_this_thread(std::size_t links);
  };
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  const FixedLink& fixed(std::size_t link) const { return fixed_->links[link]; }
  std::span<const Inertia> composite() const;
  void write_mass_row(std::size_t link, const Inertia& composite, double* m) const;
  void write_root_row(int i, double* m) const;
  void twists(const std::vector<double>& velocity);
  std::span<Spatial> inertial_forces(const std::vector<double>& velocity,
                                     const double* acceleration, const Eigen::Vector3d& gravity);

  std::shared_ptr<const Fixed> fixed_;
  std::vector<Link> links_;
  int dofs_ = 0, root_dofs_ = 0;
  double mass_ = 0;
  Inertia whole_;  // sum of the inertias of all links
};

}  // namespace kaz::sim
