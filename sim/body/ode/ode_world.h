// World that uses ODE in double precision. docs/reference/robot.md, "Dynamics", documents the settings.
// SPDX-License-Identifier: Apache-2.0
//
// QuickStep, ODE's iterative solver, shuffles its rows with ODE's global random generator. Each world keeps
// its own generator state. For each step, the world locks the global generator and sets the generator to this
// state. Therefore worlds may be stepped in different threads, but only one QuickStep runs at a time.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "sim/body/contact/contact_memory.h"
#include "sim/body/contact/ode_handles.h"
#include "sim/body/world/body_sleep.h"
#include "sim/body/world/staged_world.h"

namespace kaz::sim {

class OdeWorld final : public StagedWorld {
 public:
  // `iterations` is the number of iterations of QuickStep; 0 selects ODE's exact solver.
  OdeWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
           const WorldOptions& options, int iterations);
  OdeWorld(const OdeWorld& other);  // builds ODE's objects anew and copies the state
  ~OdeWorld() override;

  void step(std::span<const MotorDrive> drives, double supply_volts) override;
  int find_contacts() override;
  double largest_joint_gap_m() const override { return largest_gap_; }
  std::string dynamics() const override;
  void watch_contacts(bool on) override { watch_ = on; }
  void watch_loads(bool on) override;
  std::vector<ContactPoint> contacts() const override;
  void save(StateWriter& to) override;
  void restore(StateReader& from) override;
  Result<std::unique_ptr<World>> clone() const override {
    return std::make_unique<OdeWorld>(*this);
  }

 private:
  struct Joint {
    dJointID hinge = nullptr, motor = nullptr;
    // ODE writes the force and the moment of the joint `motor` to `feedback`. While loads are watched, ODE
    // also writes the force and the moment of the joint `hinge` to `bearing`.
    dJointFeedback feedback{}, bearing{};
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();  // joint axis in the child's frame
    dBodyID child = nullptr;
    int link = 0, parent = -1;    // body numbers of the child link and of its parent link
    double lower = 0, upper = 0;  // mechanical stops, rad
    // Torque of a motor that presses against a stop, Nm; empty if the motor does not press.
    std::optional<double> pressing;
  };
  struct Watched {
    Touch touch;
    dJointFeedback feedback;
  };

  template <class A>
  void transfer(A& a);
  void build();
  void copy_bodies(const OdeWorld& from);
  void make_bodies();
  void hang();
  void build_joint(Joint& joint);
  void build_passive_joint(const WorldJoint& joint);
  void find_contacts(Contacts& contacts) const;
  dBodyID body(int number) const {
    return number < 0 ? nullptr : ode_bodies_[static_cast<std::size_t>(number)];
  }
  Eigen::Isometry3d moving_pose(int body) const override;
  void kick(int body, const Eigen::Vector3d& velocity, const Eigen::Vector3d& spin) override;
  void make_contact_rows(const Contacts& contacts);
  void remember_contacts();
  void drive(std::size_t number);
  void set_row(dJointID motor, const JointMotor::Row& row) const;
  void solve();
  void keep_frames();
  void measure_forces();
  void measure_loads();
  void check_solver();
  void read_joints();
  Eigen::Vector3d imu_velocity() const;
  void read_imu(const Eigen::Vector3d& velocity_before);

  int iterations_;
  unsigned long random_state_;
  OdeThreadingHandle threading_;  // declared before ode_, so threading_ is destroyed after ode_
  OdeWorldHandle ode_;
  OdeJointGroupHandle contact_rows_;
  BodySleep sleep_;
  std::vector<dBodyID> ode_bodies_;  // indexed by body number; null: the body is fixed
  // This vector is never resized, because ODE keeps pointers to the elements.
  std::vector<Joint> ode_joints_;
  std::vector<Eigen::Isometry3d> frames_before_;  // poses of the robot's links when the step began
  ContactMemory memory_;
  bool watch_ = false;
  // ODE keeps pointers to Watched::feedback, so elements must not move. A deque does not move elements.
  std::deque<Watched> watched_;
  double largest_gap_ = 0;
};

}  // namespace kaz::sim
