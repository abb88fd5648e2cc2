// World on the Open Dynamics Engine, double precision. Settings: docs/robot.md, "Dynamics".
// SPDX-License-Identifier: Apache-2.0
//
// QuickStep shuffles its rows with ODE's one global random generator: each world keeps its own
// state of it and puts it in place for its step, under a lock. Worlds may therefore step in
// different threads, one step at a time.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sim/body/body_sleep.h"
#include "sim/body/contacts.h"
#include "sim/body/joint_motor.h"
#include "sim/body/ode_handles.h"
#include "sim/body/robot_model.h"
#include "sim/body/world.h"
#include "sim/body/world_model.h"

namespace kaz::sim {

class OdeWorld final : public World {
 public:
  // `iterations` of QuickStep; 0: ODE's exact stepper.
  OdeWorld(const WorldModel& world, const RobotModel& robot, const MotorFigures& motor,
           const WorldOptions& options, int iterations);
  ~OdeWorld() override;

  double step_s() const override { return step_s_; }
  double time_s() const override { return static_cast<double>(steps_) * step_s_; }
  void step(std::span<const MotorDrive> drives, double supply_volts) override;
  std::span<const JointState> joints() const override { return joint_states_; }
  std::span<const std::string> joint_order() const override { return joint_order_; }
  double supply_current_a() const override { return current_; }
  const ImuState& imu() const override { return imu_; }

  const Scene& scene() const override { return scene_; }
  ScenePose pose() const override;
  int head_frame() const override { return head_frame_; }

  Eigen::Isometry3d link_pose(const std::string& link) const override;
  Result<Eigen::Vector3d> object_position(const std::string& model) const override;
  // What step() begins with, by itself: for measuring it. Number of points of contact.
  int find_contacts();
  double largest_joint_gap_m() const override { return largest_gap_; }
  std::string stepper() const override;
  void watch_contacts(bool on) override { contacts_.watch(on); }
  std::vector<ContactPoint> contacts() const override { return contacts_.watched(); }
  void save(h8s::StateWriter& to) override;
  void restore(h8s::StateReader& from) override;

 private:
  struct Body {
    dBodyID id = nullptr;                           // null: stands at `fixed`
    Eigen::Vector3d com = Eigen::Vector3d::Zero();  // in the link's frame
    Eigen::Isometry3d fixed = Eigen::Isometry3d::Identity();
  };
  struct Joint {
    dJointID hinge = nullptr, motor = nullptr;
    dJointFeedback feedback{};
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();  // in the child's frame
    dBodyID child = nullptr;
  };
  struct PendingKick {
    std::int64_t step = 0;
    dBodyID body = nullptr;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  };

  template <class A>
  void transfer(A& a);
  Body make_body(const RigidLink& link, const Eigen::Isometry3d& pose);
  int add_frame(const std::string& name, const Body& body);
  void add_visuals(const RigidLink& link, int frame, const Eigen::Isometry3d& in_frame);
  void build_robot(const RobotModel& robot, const Eigen::Isometry3d& root);
  void hang();
  void build_joint(const RobotModel& robot, std::size_t number, const Eigen::Isometry3d& root);
  void build_object(const WorldBody& object);
  void kick_due();
  void drive_motors(std::span<const MotorDrive> drives, double supply_volts);
  void set_row(dJointID motor, const JointMotor::Row& row) const;
  void read_motors();
  void solve();
  void read_joints();
  Eigen::Vector3d imu_velocity() const;
  void read_imu(const Eigen::Vector3d& velocity_before);
  static Eigen::Isometry3d pose_of(const Body& body);

  double step_s_;
  int iterations_;
  std::int64_t steps_ = 0;
  unsigned long random_state_;
  OdeWorldHandle ode_;
  Contacts contacts_;
  BodySleep sleep_;
  std::vector<JointMotor> motors_;
  std::vector<std::string> joint_order_;
  std::vector<Joint> ode_joints_;  // never grows after the start: ODE writes into it
  std::vector<JointState> joint_states_;
  std::vector<Body> robot_bodies_;                 // by robot link
  std::map<std::string, RobotFrame> link_frames_;  // by link name
  std::map<std::string, Eigen::Isometry3d> fixed_objects_;
  std::map<std::string, Body> objects_;  // first link of each model that can move
  std::vector<PendingKick> kicks_;       // the next one last
  std::vector<PendingKick> all_kicks_;   // as at the start
  std::vector<Body> frames_;             // scene frame 1 onwards
  Scene scene_;
  int head_frame_ = -1;
  double current_ = 0;
  RobotFrame imu_frame_;
  ImuState imu_;
  double largest_gap_ = 0;
};

}  // namespace kaz::sim
