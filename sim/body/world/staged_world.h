// Base class of simulated worlds. Contains everything that does not depend on the solver: bodies, scene,
// names, kicks, motors and readings.
// SPDX-License-Identifier: Apache-2.0
//
// Constant data is in a StageModel, which all clones share. The members of StagedWorld are the state of one
// world.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/body/contact/contacts.h"
#include "sim/body/motor/joint_motor.h"
#include "sim/body/motor/stop_margin.h"
#include "sim/body/world/stage_model.h"

namespace kaz::sim {

// Error reduction parameter (ERP) of a joint stop for a step of 1 ms (contact_surface.h).
constexpr double kStopErp = 0.2;
// Compliance of a joint stop for a step of 1 ms, rad/s per Nm. With kStopSoftness and kStopErp, a stop yields
// by 1 mrad under the motor's maximum torque of 2.4 Nm. A real end stop (plastic against steel) also yields
// by about 1 mrad under this torque. An iterative solver leaves a residual. At a rigid stop, this residual
// would make the joint bounce.
constexpr double kStopSoftness = 0.08;

class StagedWorld : public World {
 public:
  double step_s() const override { return step_s_; }
  double time_s() const override { return static_cast<double>(steps_) * step_s_; }
  std::span<const JointState> joints() const override { return joint_states_; }
  std::span<const std::string> joint_order() const override { return model_->joint_order; }
  double supply_current_a() const override { return current_; }
  const ImuState& imu() const override { return imu_; }
  const servo_model::IdentifiedServo* servo() const override { return servo_.get(); }
  std::span<const LinkForce> link_forces() const override { return link_forces_; }
  std::span<const std::string> link_order() const override { return model_->link_order; }
  void watch_loads(bool on) override { watch_loads_ = on; }
  std::span<const JointLoad> joint_loads() const override { return joint_loads_; }
  const Scene& scene() const override { return model_->scene; }
  ScenePose pose() const override;
  int head_frame() const override { return model_->head_frame; }
  Eigen::Isometry3d link_pose(const std::string& link) const override;
  Result<Eigen::Vector3d> object_position(const std::string& model) const override;
  Result<void> push(const std::string& link, const Eigen::Vector3d& impulse) override;
  Result<void> accelerate(const std::string& model, const Eigen::Vector3d& change,
                          const Eigen::Vector3d& spin = Eigen::Vector3d::Zero()) override;
  // Runs only the collision detection of step(), for benchmarks. Returns the number of contact points.
  virtual int find_contacts() = 0;
  const SolverDiagnostics& diagnostics() const override { return diagnostics_; }

 protected:
  using Body = StageModel::Body;
  // Impulse on a moving link of the robot, applied in the next step.
  struct HandPush {
    std::uint32_t link = 0;
    // The impulse acts at the link's center of mass. Unit: N s, in world axes.
    Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
    template <class A>
    void transfer(A& a) {
      a(link);
      for (int k = 0; k < 3; ++k) a(impulse[k]);
    }
  };

  StagedWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
              const WorldOptions& options);
  StagedWorld(const StagedWorld&) = default;  // shares the StageModel, copies the state

  const std::vector<Body>& bodies() const { return model_->bodies; }
  // World pose of the link's frame, for bodies that move.
  virtual Eigen::Isometry3d moving_pose(int body) const = 0;
  // Adds `velocity` (m/s) and `spin` (rad/s), in world axes, to the velocities of an object and wakes the
  // object.
  virtual void kick(int body, const Eigen::Vector3d& velocity, const Eigen::Vector3d& spin) = 0;
  Eigen::Isometry3d body_pose(int body) const;  // world pose of the link's frame, for every body
  // Applies the kicks and pushes that are due at the current step.
  void kick_due();
  // Applies the elements of `kicks` that are due at `step`. `left` is the number of elements that are not
  // applied yet; the function updates `left`.
  void take_due(const std::vector<StageModel::Kick>& kicks, std::size_t& left, std::int64_t step);
  bool has_stepped() const;  // returns whether one of StageModel::feet has risen by kFirstStep
  // Computes each motor's row of the constraint solver from the present joint states.
  void prepare_motors(std::span<const MotorDrive> drives, double supply_volts);
  // Updates the motors after the step, with the new joint states and external torques.
  void finish_motors();
  // Validity checks of one step. A check that fails sets diagnostics_.failure and returns false.
  static constexpr double kMaxTurn = 1, kMaxTravel = 1;  // rad and m per step
  bool drives_are_numbers();
  bool joint_can_turn(const std::string& joint, double velocity);
  bool body_can_move(std::size_t body, const Eigen::Vector3d& velocity,
                     const Eigen::Vector3d& angular);
  // Records the failure `why` in diagnostics_.failure. If a failure is already recorded, break_down()
  // changes nothing.
  void break_down(const std::string& why);
  void read_motors();  // copies currents and temperatures to the joint states
  // Archives the state of this class.
  template <class A>
  void transfer_stage(A& a) {
    auto count = static_cast<std::uint32_t>(bodies().size());
    auto kicks = static_cast<std::uint32_t>(kicks_left_);
    a(count, kicks);
    // After a return to an earlier state, kicks that were already applied are due again.
    if (count != bodies().size() || kicks > model_->kicks.size()) {
      return a.refuse("it belongs to another world");
    }
    if (!a.good()) return;
    kicks_left_ = kicks;
    if (!model_->feet.empty()) {
      auto pushes = static_cast<std::uint32_t>(pushes_left_);
      a(pushes, first_step_);
      if (pushes > model_->pushes.size() || first_step_ < -1)
        return a.refuse("it belongs to another world");
      if (!a.good()) return;
      pushes_left_ = pushes;
    }
    a(steps_, current_, hand_pushes_, diagnostics_.unconverged_steps, diagnostics_.max_residual,
      diagnostics_.first_s, diagnostics_.last_s, diagnostics_.drift);
    for (const HandPush& push : hand_pushes_) {
      if (push.link >= robot_links_ || !bodies()[push.link].moves || (hung_ && push.link == 0))
        return a.refuse("one of its pushes acts on a link that does not exist or cannot move");
    }
    for (JointMotor& motor : motors_) a(motor);
    for (JointState& joint : joint_states_) {
      a(joint.angle, joint.velocity, joint.torque, joint.current, joint.winding_celsius);
    }
    for (Eigen::Vector3d* v : {&imu_.angular_velocity, &imu_.specific_force})
      for (int k = 0; k < 3; ++k) a((*v)[k]);
    for (LinkForce& force : link_forces_) a(force);
    if constexpr (A::reading) {
      diagnostics_.failure.clear();  // failed worlds are not saved
      joint_loads_.clear();
      read_motors();  // computes the readings that the archive does not contain
    }
  }

  std::shared_ptr<const StageModel> model_;
  double step_s_;
  Eigen::Vector3d gravity_;
  std::int64_t steps_ = 0;
  bool hung_ = false;  // true: the root link is fixed
  std::size_t robot_links_;
  std::size_t kicks_left_ = 0;  // number of the model's kicks not yet applied
  std::size_t pushes_left_ = 0;
  std::int64_t first_step_ = -1;  // simulation step in which has_stepped() became true; -1: not yet
  std::vector<JointMotor> motors_;
  std::vector<JointMotor::Row> rows_;  // row of each motor for the current step
  // Identified servo of the motors, or null, and the external torque on each of its joints in the last step.
  std::shared_ptr<const servo_model::IdentifiedServo> servo_;
  std::vector<double> external_nm_;
  std::vector<JointState> joint_states_;
  RobotFrame imu_frame_;
  ImuState imu_;
  std::vector<LinkForce> link_forces_;  // indexed by link of the robot
  bool watch_loads_ = false;
  std::vector<JointLoad> joint_loads_;  // indexed by joint; empty if loads are not watched
  double current_ = 0;
  std::vector<HandPush> hand_pushes_;
  SolverDiagnostics diagnostics_;
};

// The parsed files of a world.
struct WorldFiles {
  WorldModel world;
  RobotModel robot;
  MotorParams motor;  // without backlash and heat if WorldOptions::ideal_motors is true
};
// Loads the world file, the robot file, and motor.xml in the folder of the robot file. An error message names
// file and line.
Result<WorldFiles> read_world_files(const std::string& world_path, const std::string& robot_path,
                                    const WorldOptions& options);

// Builds a world with the dynamics engine selected by the options. Fails if the engine is unknown or the step
// size is out of range. Also fails if a foot or a push names a link that does not exist, or if a pushed link
// is fixed.
Result<std::unique_ptr<StagedWorld>> make_world(const WorldModel& world, const RobotModel& robot,
                                                const MotorParams& motor,
                                                const WorldOptions& options);

}  // namespace kaz::sim
