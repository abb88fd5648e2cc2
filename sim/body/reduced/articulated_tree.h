// Dynamics of a tree of rigid links in reduced coordinates: one coordinate per joint, and six for a floating
// base. By construction, joints cannot drift apart.
// SPDX-License-Identifier: Apache-2.0
//
// Sources: R. Featherstone, "Rigid Body Dynamics Algorithms" (2008): composite-rigid-body inertia
// (6.2), recursive Newton-Euler bias (5.3).
//
// All spatial quantities are in world axes about the same point P, the present origin of the root link. So
// inertias and forces of links can be added without transforms. For a floating base, the velocity vector v
// begins with the angular velocity of the root (rad/s) and the velocity of P (m/s), world axes. Then follow
// the joint rates (rad/s) in the order of links, parents first.
//
//   M(q) dv/dt + c(q, v) = tau
//
// No allocation after the first step in a thread. All sums have a fixed order, so equal input gives equal
// bits. Copies share constant data.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/body/description/robot_model.h"

namespace kaz::sim {

// Spatial vector about P. Motion: angular velocity and velocity of P. Force: moment about P and force.
struct Spatial {
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
};

class ArticulatedTree {
 public:
  // `root`: world pose of the root link. `held` fixes the base even if the model's base is floating.
  ArticulatedTree(const RobotModel& robot, const Eigen::Isometry3d& root, bool held);

  int dofs() const { return dofs_; }
  int root_dofs() const { return root_dofs_; }
  int dof_of_joint(int joint) const { return fixed_->dof_of_joint[index(joint)]; }
  int link_of_dof(int dof) const { return dof - root_dofs_ + 1; }

  // State. `angle` (rad) contains only the joints, `velocity` all coordinates.
  Eigen::Vector3d root_at;  // m, world
  Eigen::Quaterniond root_turn;
  std::vector<double> angle;  // indexed by coordinate - root_dofs()
  std::vector<double> velocity;

  // Forward kinematics: computes poses, joint axes and inertias. Call after each change of root pose or
  // `angle`.
  void place();
  const Eigen::Matrix3d& axes(int link) const { return links_[index(link)].axes; }
  Eigen::Vector3d origin(int link) const { return root_at + links_[index(link)].origin; }
  Eigen::Vector3d com(int link) const { return root_at + links_[index(link)].com; }
  // Returns the velocity (m/s, world axes) of a point that is fixed to a link. `point` is in the world frame,
  // m. Valid after velocities().
  Eigen::Vector3d velocity_at(int link, const Eigen::Vector3d& point) const;
  Eigen::Vector3d angular_velocity(int link) const { return links_[index(link)].twist.angular; }
  // Computes the links' twists from `velocity`.
  void velocities() { twists(velocity); }

  // Momentum at `velocity`: linear (kg m/s), and angular about the centre of mass (kg m2/s).
  struct Momentum {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
  };
  Momentum momentum();
  // Changes the velocity of a floating base so that momentum() becomes `to`. Joint velocities stay unchanged.
  // No effect on a fixed base.
  void set_momentum(const Momentum& to);
  Eigen::Vector3d mass_centre() const;  // m, world
  double mass() const { return mass_; }
  double kinetic_energy();  // J

  // Computes M for the present pose (composite-rigid-body algorithm). `row(i)` must return a pointer to row
  // i. In each row, only the diagonal and the columns of ancestors are written.
  template <class Row>
  void mass_matrix(Row row) const {
    const std::span<const Inertia> composites = composite();
    for (std::size_t i = 1; i < links_.size(); ++i)
      write_mass_row(i, composites[i], row(fixed(i).dof));
    for (int i = 0; i < root_dofs_; ++i) write_root_row(i, row(i));
  }
  // Computes c(q, v) in N m and N: the generalized forces at which, under gravity, no coordinate accelerates
  // (recursive Newton-Euler with zero acceleration). `c` must have dofs() entries.
  void bias(const std::vector<double>& velocity, const Eigen::Vector3d& gravity,
            std::vector<double>& c);

  // Computes the spatial force transmitted to each link through its parent joint, for motion at `velocity`
  // with `acceleration` (recursive Newton-Euler). `forces` has one entry per link. On entry, it contains the
  // external forces without gravity, on return the joint forces. The root's entry is then the force needed at
  // the base for this motion.
  void joint_forces(const std::vector<double>& velocity, const std::vector<double>& acceleration,
                    const Eigen::Vector3d& gravity, std::vector<Spatial>& forces);

  // Range of coordinates that includes the joint of a link and the joints of all its ancestors, but not the
  // root's six coordinates.
  struct Span {
    int first = 0, end = 0;
  };
  Span span_of_link(int link) const { return fixed(index(link)).span; }
  Span span_of_dof(int dof) const { return fixed(index(dof - root_dofs_ + 1)).span; }
  // Coordinate of the parent link's joint; -1: the parent is the root.
  int carrier_of_dof(int dof) const {
    return fixed(index(fixed(index(dof - root_dofs_ + 1)).parent)).dof;
  }
  // Computes out += J^T force for a force (N, or impulse in N s) at a point of a link. `force` and `point`
  // are in the world frame.
  void add_force(int link, const Eigen::Vector3d& point, const Eigen::Vector3d& force,
                 double* out) const;
  // Adds `sign` times the link's geometric Jacobian about P to `columns`. Each column has six numbers
  // (angular, linear). The column of joint coordinate i begins at columns + 6 (i - first). The columns of the
  // root's six coordinates are not written.
  void add_motions(int link, double sign, int first, double* columns) const;

 private:
  struct Inertia {  // about P
    double mass = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();  // mass * center
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
    Eigen::Vector3d in_parent = Eigen::Vector3d::Zero();    // origin, parent's axes
    Eigen::Matrix3d at_zero = Eigen::Matrix3d::Identity();  // axes at angle 0, parent's axes
    Eigen::Vector3d own_axis = Eigen::Vector3d::UnitX();    // joint axis, own axes
    double mass = 0;
    Eigen::Vector3d own_com = Eigen::Vector3d::Zero();          // own axes
    Eigen::Matrix3d own_inertia = Eigen::Matrix3d::Identity();  // about com, own axes
  };
  struct Fixed {
    std::vector<FixedLink> links;
    std::vector<int> dof_of_joint;
  };
  // Data of a link for the present pose; vectors from P.
  struct Link {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(), com = Eigen::Vector3d::Zero();
    Spatial motion;  // motion subspace S: motion of the link if its joint turns at 1 rad/s
    Inertia inertia;
    Spatial twist;
  };
  // Working memory of one computation, by link. Each thread has one Scratch for all trees.
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
  Inertia whole_;  // sum over all links
};

}  // namespace kaz::sim
