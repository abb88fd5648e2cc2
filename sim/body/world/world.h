// The simulated world: robot, ground and objects as rigid bodies with joints, motors and contacts. Only
// motors, gravity and contacts move the robot.
// SPDX-License-Identifier: Apache-2.0
//
// Units m, kg, s, rad, N. World frame: x forward from the robot's start, y left, z up, ground at z = 0.
// Joint order: shared/board/joints.def for Kaz, the URDF's order for other robots.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/archive.hpp"
#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"
#include "sim/body/motor/motor_drive.h"
#include "sim/body/world/loads.h"

namespace kaz::sim {

struct JointState {
  double angle = 0;     // rad, at the output shaft, as the potentiometer sees it
  double velocity = 0;  // rad/s
  double torque = 0;    // Nm, motor on joint in the last step, friction included
  double current = 0;   // A, through the motor, mean over the last step
  double winding_celsius = 0;
  double case_celsius = 25;  // of the motor
};

// Reading of an ideal inertial sensor at the robot's link `imu`, in the axes of that link; at the root
// link's origin if the robot has none. Acceleration is the mean over the last step, velocity is at its end.
struct ImuState {
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();    // acceleration minus gravity, m/s^2
};

// A contact point between two shapes.
struct ContactPoint {
  std::string a, b;                              // links; "model::link" in worlds
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // world frame, m
  Eigen::Vector3d force =
      Eigen::Vector3d::Zero();  // on `a`, world axes, mean over the last step, N
};

// Solver health since the world was loaded.
struct SolverDiagnostics {
  std::string failure;  // why stepping stopped, one sentence; empty while the world runs
  std::int64_t unconverged_steps = 0;
  double max_residual = 0;  // largest velocity change left in an unconverged step, m/s or rad/s
  double first_s = 0, last_s = 0;  // of the unconverged steps
  double drift = 0;                // residual times step, summed over them: m or rad
  // m or rad; up to this the unconverged steps are far below what the potentiometers resolve.
  static constexpr double kNegligibleDrift = 1e-4;
  // One sentence: which steps, by how much, and whether the result can be trusted; empty if there are none.
  std::string summary() const;
};

struct WorldOptions {
  std::uint64_t seed = 1;
  double step_s = 0.001;
  std::string dynamics = "reduced";  // "reduced"; ODE: "exact", or "quickN" with N iterations
  bool hung = false;          // suspended: the trunk is fixed, the feet are clear of the ground
  std::string motor = "";     // name in motor.xml, beside the URDF; "": the file's default
  bool ideal_motors = false;  // without backlash and heat
};

class World {
 public:
  // world_path: SDF; robot_path: URDF. Errors name file and line.
  static Result<std::unique_ptr<World>> load(const std::string& world_path,
                                             const std::string& robot_path,
                                             const WorldOptions& options);
  virtual ~World() = default;

  virtual double step_s() const = 0;
  virtual double time_s() const = 0;
  // Advances by step_s(). One drive for each joint, in joint order; motors past the end of `drives` have
  // an open bridge. Does nothing once diagnostics().failure is set.
  virtual void step(std::span<const MotorDrive> drives, double supply_volts) = 0;
  virtual std::span<const JointState> joints() const = 0;
  virtual std::span<const std::string> joint_order() const = 0;  // names, as joints() has them
  virtual double supply_current_a() const = 0;  // sum of the motors' currents in the last step
  virtual const ImuState& imu() const = 0;
  // External contact forces on the robot's links, in the order of link_order(); updated by each step.
  virtual std::span<const LinkForce> link_forces() const { return {}; }
  virtual std::span<const std::string> link_order() const { return {}; }
  // Reaction forces in the joints in the last step, in joint order; empty unless watch_loads(true) was
  // in effect. Watching costs time and does not change the motion.
  virtual void watch_loads(bool on) { static_cast<void>(on); }
  virtual std::span<const JointLoad> joint_loads() const { return {}; }

  virtual const Scene& scene() const = 0;
  virtual ScenePose pose() const = 0;
  // Index in pose() of the link that carries `left_eye` and `right_eye`; the cameras' optical centres are
  // given in its frame (sim/view/camera.h). -1: the robot has no eyes.
  virtual int head_frame() const = 0;

  // Ground truth, for tests, measurements and scoring only. World frame. Error: no such model.
  virtual Eigen::Isometry3d link_pose(const std::string& link) const = 0;
  virtual Result<Eigen::Vector3d> object_position(const std::string& model) const = 0;
  virtual double largest_joint_gap_m() const = 0;  // constraint error of the joints since the start
  virtual std::string dynamics() const = 0;
  // Whether diagnostics() counts unconverged steps.
  virtual bool measures_convergence() const { return false; }
  // Since the start. ODE reports no residual: its worlds set `failure` only.
  virtual const SolverDiagnostics& diagnostics() const {
    static const SolverDiagnostics none;
    return none;
  }
  // Contacts of the last step; empty unless watch_contacts(true) was in effect. Watching costs time and
  // does not change the motion.
  virtual void watch_contacts(bool on) { static_cast<void>(on); }
  virtual std::vector<ContactPoint> contacts() const { return {}; }

  // Applies an impulse to a link of the robot at its centre of mass in the next step; N s, world axes. For
  // disturbance tests only. Errors: no such link, the link is fixed, or this world does not support it.
  virtual Result<void> push(const std::string& link, const Eigen::Vector3d& impulse) {
    static_cast<void>(impulse);
    return fail(Fault::usage, "this world cannot push `" + link + "`; load one with World::load");
  }

  // Changes the velocity of an object by so much, m/s, world axes, as a short push through its centre of mass
  // does. Errors: no such object, it does not move, or this world does not support it.
  virtual Result<void> accelerate(const std::string& model, const Eigen::Vector3d& change) {
    static_cast<void>(change);
    return fail(Fault::usage, "this world cannot push `" + model + "`; load one with World::load");
  }

  // A second world in the same state, which goes on exactly as this one would. Both share what never changes
  // (shapes, links, parameters) and are otherwise independent: either may be destroyed first, and each may be
  // stepped in a thread of its own. Takes microseconds where loading takes tens of milliseconds. Not while
  // this world is being stepped in another thread. Error: this kind of world cannot be cloned.
  virtual Result<std::unique_ptr<World>> clone() const {
    return fail(Fault::usage, "this kind of world cannot be cloned; load another one");
  }

  // Saves and restores the state carried from step to step; restore() needs a world built from the same
  // files and options. Worlds that cannot be saved fail the archive.
  virtual void save(StateWriter& to) { to.refuse("this kind of world cannot be saved"); }
  virtual void restore(StateReader& from) { from.refuse("this kind of world cannot be restored"); }
};

}  // namespace kaz::sim
