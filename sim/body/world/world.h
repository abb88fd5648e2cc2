// The simulated world: robot, ground and objects as rigid bodies with joints, motors and contacts.
// SPDX-License-Identifier: Apache-2.0
//
// Units: m, kg, s, rad, N. World frame: z up, ground at z = 0. By default the robot starts at the origin and
// faces +x; +y is to its left. Joint order: shared/board/joints.def for Kaz, file order for other robots.
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
  double angle = 0;     // rad, at the output shaft, which the potentiometer measures
  double velocity = 0;  // rad/s
  double torque = 0;    // Nm, of the motor on the joint in the last step, with friction
  double current = 0;   // A, through the motor, mean over the last step
  double winding_celsius = 0;
  double case_celsius = 25;  // motor case
};

// Readings of an ideal inertial sensor at the robot's link `imu`, in the axes of that link. If the robot has
// no such link, the sensor is at the root link's origin. The angular velocity is that at the end of the last
// step, the acceleration is the mean over it.
struct ImuState {
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();    // acceleration minus gravity, m/s^2
};

// Contact point between two shapes.
struct ContactPoint {
  std::string a, b;                                 // links; of objects "model/link"
  Eigen::Vector3d at = Eigen::Vector3d::Zero();     // world frame, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, on `a`, world axes, mean over a step
};

// Convergence and failure of the solver since the start.
struct SolverDiagnostics {
  std::string failure;  // why stepping stopped, one sentence; else empty
  std::int64_t unconverged_steps = 0;
  double max_residual = 0;         // largest remaining velocity change, m/s or rad/s
  double first_s = 0, last_s = 0;  // times of the first and last unconverged step
  double drift = 0;                // sum of residual times step, m or rad
  // m or rad. A drift up to this limit is far below the resolution of the potentiometers.
  static constexpr double kNegligibleDrift = 1e-4;
  // Returns one sentence: which steps, how large the error, and whether the result can be trusted. Empty if
  // all steps converged.
  std::string summary() const;
};

struct WorldOptions {
  std::uint64_t seed = 1;
  double step_s = 0.001;             // above 0, at most 0.01
  std::string dynamics = "reduced";  // "reduced"; ODE: "exact" or "quickN", N from 1 to 1000
  bool hung = false;                 // suspended: root link fixed, feet clear of the ground
  std::string motor = "";            // name in motor.xml beside the URDF; "": the file's default
  bool ideal_motors = false;         // without backlash and heat
};

// A world may be used in one thread at a time. Different worlds, clones included, may be used in different
// threads.
class World {
 public:
  // Loads a world (SDF) and a robot (URDF, with motor.xml beside it). Errors: an invalid file (with its
  // line), invalid options, or a robot that starts inside a model.
  static Result<std::unique_ptr<World>> load(const std::string& world_path,
                                             const std::string& robot_path,
                                             const WorldOptions& options);
  virtual ~World() = default;

  virtual double step_s() const = 0;
  virtual double time_s() const = 0;
  // Advances by step_s(). `drives`: one per joint, in joint order; missing ones count as an open bridge.
  // Does nothing once diagnostics().failure is set.
  virtual void step(std::span<const MotorDrive> drives, double supply_volts) = 0;
  virtual std::span<const JointState> joints() const = 0;
  virtual std::span<const std::string> joint_order() const = 0;  // names, in the order of joints()
  virtual double supply_current_a() const = 0;                   // sum over the motors, last step
  virtual const ImuState& imu() const = 0;
  // External contact forces on the robot's links in the last step, in the order of link_order(). Empty if
  // this world does not measure them.
  virtual std::span<const LinkForce> link_forces() const { return {}; }
  virtual std::span<const std::string> link_order() const { return {}; }
  // Reaction forces in the joints in the last step, in joint order. Empty unless watch_loads(true) was in
  // effect, which costs time and does not change the motion.
  virtual void watch_loads(bool on) { static_cast<void>(on); }
  virtual std::span<const JointLoad> joint_loads() const { return {}; }

  virtual const Scene& scene() const = 0;
  virtual ScenePose pose() const = 0;
  // Index in pose() of the link that carries `left_eye` and `right_eye`, -1 for a robot without eyes. The
  // optical centers of the cameras are given in its frame (sim/view/camera.h).
  virtual int head_frame() const = 0;

  // Ground truth, for tests, measurements and evaluation only. World frame.
  // Pose of a robot link's frame; identity if the robot has no such link.
  virtual Eigen::Isometry3d link_pose(const std::string& link) const = 0;
  // Position of the first link of a model. Error: no such model.
  virtual Result<Eigen::Vector3d> object_position(const std::string& model) const = 0;
  virtual double largest_joint_gap_m() const = 0;  // largest joint constraint error since the start
  virtual std::string dynamics() const = 0;        // the engine, as in WorldOptions
  // Returns true if diagnostics() counts unconverged steps.
  virtual bool measures_convergence() const { return false; }
  // ODE reports no residual, so its worlds set only `failure`.
  virtual const SolverDiagnostics& diagnostics() const {
    static const SolverDiagnostics none;
    return none;
  }
  // Contacts of the last step. Empty unless watch_contacts(true) was in effect, which costs time and does not
  // change the motion.
  virtual void watch_contacts(bool on) { static_cast<void>(on); }
  virtual std::vector<ContactPoint> contacts() const { return {}; }

  // Applies an impulse (N s, world axes) to a link of the robot at its center of mass in the next step. For
  // disturbance tests only. Errors: no such link, the link is fixed, or this world does not support pushes.
  virtual Result<void> push(const std::string& link, const Eigen::Vector3d& impulse) {
    static_cast<void>(impulse);
    return fail(Fault::usage, "this world cannot push `" + link + "`; load one with World::load");
  }

  // Adds `change` (m/s, world axes) to the velocity of an object, like a short push through its center of
  // mass. Errors: no such object, the object is fixed, or this world does not support pushes.
  virtual Result<void> accelerate(const std::string& model, const Eigen::Vector3d& change) {
    static_cast<void>(change);
    return fail(Fault::usage, "this world cannot push `" + model + "`; load one with World::load");
  }

  // Returns a second world in the same state, which continues exactly as this one would. Both share constant
  // data (shapes, links, parameters) and are otherwise independent: either may be destroyed first, and each
  // may be stepped in its own thread. Takes microseconds; loading takes tens of milliseconds. Do not call
  // while another thread steps this world. Error: this kind of world cannot be cloned.
  virtual Result<std::unique_ptr<World>> clone() const {
    return fail(Fault::usage, "this kind of world cannot be cloned; load another one");
  }

  // Save and restore the state carried from step to step. restore() needs a world built from the same files
  // and options. Worlds that cannot be saved fail the archive.
  virtual void save(StateWriter& to) { to.refuse("this kind of world cannot be saved"); }
  virtual void restore(StateReader& from) { from.refuse("this kind of world cannot be restored"); }
};

}  // namespace kaz::sim
