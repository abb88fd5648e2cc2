// World in reduced coordinates. Joints do not drift, motors are integrated implicitly, friction is limited by
// cones, and all contacts are solved together.
// SPDX-License-Identifier: Apache-2.0
//
// docs/explanation/dynamics.md describes the formulation. A step of h seconds begins with coordinates q and
// velocities v. If surfaces with restitution hit each other, the impact changes v (reduced_impact.cpp). Then
// the step consists of four parts:
//   1. Find the contacts (contacts.h) and compute the row of each joint's motor (joint_motor.h).
//   2. Solve for the velocities by Newton's method (velocity_solver.h). The bias c is computed for the
//      velocity in the middle of the step. This velocity is extrapolated from the velocities at the beginning
//      of the previous step and of the present step. Therefore the velocity-dependent forces are accurate to
//      second order.
//   3. Set q += h v. If the robot is in flight, its root moves with the midpoint velocity of the root, not
//      with v. A free body in flight moves with the mean of its old and new velocity.
//   4. Set the robot's momentum to the old momentum plus the impulses of contacts and gravity, so that errors
//      of the momentum do not accumulate. This correction changes the root's velocity by terms of order h^2.
//
// The members of ReducedWorld are the state that is kept from step to step. clone() copies all members. The
// temporary data of a step is in a Work object. Each thread has one Work object and uses this object for all
// its worlds. Therefore the object stays in the processor's cache.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/body/contact/contact_memory.h"
#include "sim/body/reduced/articulated_tree.h"
#include "sim/body/reduced/free_body.h"
#include "sim/body/reduced/passive_joint.h"
#include "sim/body/reduced/velocity_solver.h"
#include "sim/body/world/staged_world.h"

namespace kaz::sim {

class ReducedWorld final : public StagedWorld {
 public:
  ReducedWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
               const WorldOptions& options);

  void step(std::span<const MotorDrive> drives, double supply_volts) override;
  int find_contacts() override;
  Result<std::unique_ptr<World>> clone() const override {
    return std::make_unique<ReducedWorld>(*this);
  }
  double largest_joint_gap_m() const override { return 0; }  // joints cannot open
  std::string dynamics() const override { return "reduced"; }
  bool measures_convergence() const override { return true; }
  void watch_contacts(bool on) override { watch_ = on; }
  std::vector<ContactPoint> contacts() const override;
  void save(StateWriter& to) override;
  void restore(StateReader& from) override;

  // Convergence of the last step.
  struct Effort {
    int steps = 0;        // Newton iterations
    double residual = 0;  // largest velocity change in the last iteration, m/s or rad/s
  };
  const Effort& effort() const { return effort_; }
  const ArticulatedTree& tree() const { return tree_; }
  // Coordinates of the passive joints, in the order of WorldModel::joints, rad or m; 0 at the start and for
  // ball joints. Joints between two fixed bodies are left out.
  const std::vector<double>& passive_joints() const { return passive_angle_; }

 private:
  struct Joint {
    std::string name;
    int dof = 0;
    double lower = 0, upper = 0;  // rad, mechanical stops
  };
  // A joint without a motor: its angle is ratio times the leader's angle plus the offset (rad).
  struct Follower {
    int dof = 0, leader_dof = 0;
    double ratio = 1, offset = 0;
  };
  // Impulse (normal and friction) and moment (rolling and spin) of a contact point in the last step.
  // ContactMemory stores the shear of soft contacts.
  struct Memory {
    std::uint32_t shape_a = 0, shape_b = 0;
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    Eigen::Vector3d impulse = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    template <class A>
    void transfer(A& a) {
      a(shape_a, shape_b);
      for (int k = 0; k < 3; ++k) a(at[k], impulse[k], moment[k]);
    }
  };
  struct Chain {  // chain of joints; each chain is a block of the solver's matrix
    int first = 0, length = 0, carrier = -1;
  };
  struct Layout {               // constant, shared by all clones
    std::vector<Joint> joints;  // joints with a motor, then joints that follow another joint
    std::vector<Follower> followers;
    std::vector<Chain> chains;
    std::vector<PassiveJoint> passive;  // joints between objects
    std::vector<bool> jointed;  // for each object: whether it has such a joint; it never sleeps
  };
  struct Meeting {  // two bodies in contact
    // `pair` is the index in the solver; -1: neither body can move.
    int body_a = -1, body_b = -1, pair = -1;
    Eigen::Vector3d about = Eigen::Vector3d::Zero();  // reference point of the relative motion, m
  };
  struct Push {  // contact point of the solver; the point's impulse acts on body_a
    std::size_t touch = 0;
    Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();  // columns: normal, two tangents
  };
  // Working memory of one step.
  struct Work {
    // Returns the instance of the calling thread, sized for `world`.
    static Work& of_this_thread(const ReducedWorld& world);
    Contacts& contacts = Contacts::of_this_thread();
    VelocitySolver solver;
    std::vector<double> bias, halfway, acceleration;  // indexed by coordinate of the tree
    std::vector<double> momentum, velocity, change;   // indexed by coordinate of the solver
    std::vector<Spatial> outer;                       // external force on each link
    // Index of the first of the six coordinates (angular, linear) of each object; -1: the object sleeps.
    std::vector<int> coordinate_of;
    std::vector<Meeting> meetings;
    std::vector<Push> pushes;  // indexed by contact point of the solver
    // For each object: true if the object has no contacts, or only leaves surfaces with restitution.
    std::vector<bool> flies;
    // reduced_impact.cpp
    std::vector<VelocitySolver::Impulse> struck;  // indexed like `pushes`; empty: no impact
    std::vector<double> unstruck;                 // velocities before the impact
    std::vector<double> elastic, product, share;
    // Impulse in this step, with that of an impact.
    VelocitySolver::Impulse impulse(std::size_t push) const {
      const VelocitySolver::Impulse& l = solver.impulse(push);
      return struck.empty() ? l : VelocitySolver::Impulse(l + struck[push]);
    }
  };

  template <class A>
  void transfer(A& a);
  Eigen::Isometry3d moving_pose(int body) const override;
  void kick(int body, const Eigen::Vector3d& velocity, const Eigen::Vector3d& spin) override;
  bool of_robot(int body) const {
    return body >= 0 && static_cast<std::size_t>(body) < robot_links_;
  }
  FreeBody& object(int body) { return objects_[static_cast<std::size_t>(body) - robot_links_]; }
  const FreeBody& object(int body) const {
    return objects_[static_cast<std::size_t>(body) - robot_links_];
  }
  void settle_sleep(Work& work);
  static Layout layout_of(const RobotModel& robot, const ArticulatedTree& tree);
  static std::vector<Chain> chains_of(const ArticulatedTree& tree);
  void find_contacts(Contacts& contacts) const;
  void write_inertia(Work& work) const;
  void write_momentum(Work& work);
  VelocitySolver::Impulse recall(const Touch& touch, const Eigen::Matrix3d& basis) const;
  void begin_rows(Work& work) const;
  bool place_point(Work& work, std::size_t number, VelocitySolver::Point& point) const;
  static void add_point(Work& work, std::size_t number, const VelocitySolver::Point& point);
  void make_contact_row(Work& work, std::size_t number) const;
  // reduced_impact.cpp
  double pressing(const Touch& touch) const;
  double approach(const Touch& touch) const;
  double bounce(const Touch& touch) const;
  void strike(Work& work);
  void limit_energy(Work& work);
  const Meeting& meeting_of(Work& work, const Touch& touch) const;
  void make_pair(Work& work, const Touch& touch) const;
  Eigen::Vector3d velocity_at(int body, const Eigen::Vector3d& point) const;
  void make_joint_rows(Work& work) const;
  void make_coupling_rows(Work& work) const;
  // passive_joint_rows.cpp
  const FreeBody* object_or_null(int number) const {
    return number < 0 ? nullptr : &objects_[static_cast<std::size_t>(number)];
  }
  void add_passive_joints();
  void make_passive_rows(Work& work) const;
  void make_passive_axis_rows(Work& work, std::size_t number, const Eigen::Vector3d& at,
                              const Eigen::Vector3d& axis) const;
  VelocitySolver::Tie tie_of(const Work& work, const PassiveJoint& joint, const Eigen::Vector3d& at,
                             const Eigen::Vector3d& along, bool turns) const;
  static double tie_velocity(const Work& work, const VelocitySolver::Tie& tie);
  void read_passive_joints();
  void run_solver(Work& work);
  void solve(Work& work);
  void read_servo_torques(Work& work);
  bool can_move(const Work& work);
  void move_tree(double seconds);
  void fly(const ArticulatedTree::Momentum& after, const Eigen::Vector3d& centre);
  void measure_forces(Work& work);
  void measure_loads(Work& work);
  void advance(Work& work);
  void read_joints();
  Eigen::Vector3d imu_velocity() const;
  void read_imu(const Eigen::Vector3d& velocity_before);

  ArticulatedTree tree_;
  std::shared_ptr<const Layout> layout_;
  std::vector<double> passive_angle_;  // coordinate of each passive joint, rad or m
  std::vector<FreeBody> objects_;      // objects_[i] has the body number robot_links_ + i
  std::vector<Memory> memory_;
  ContactMemory shear_;
  Effort effort_;
  bool watch_ = false;
  std::vector<ContactPoint> watched_;
  std::vector<double> velocity_before_;  // velocities of the tree one step ago
};

}  // namespace kaz::sim
