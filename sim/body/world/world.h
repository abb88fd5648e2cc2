// The simulated world: robot, ground and objects as rigid bodies with joints, motors and contacts.
// SPDX-License-Identifier: Apache-2.0
//
// Units: m, kg, s, rad, N. World frame: z up, ground at z = 0. By default the robot starts at the origin and
// faces +x; +y is to the robot's left. Kaz's joints are in the order of shared/board/joints.def. The joints
// of another robot are in the order of its URDF.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/archive.hpp"
#include "shared/base/result.hpp"
#include "shared/servo_model/servo_file.h"
#include "sim/body/description/reading.h"
#include "sim/body/description/scene.h"
#include "sim/body/motor/motor_drive.h"
#include "sim/body/world/loads.h"

namespace kaz::sim {

struct RobotModel;

struct JointState {
  double angle = 0;     // angle of the output shaft, rad; the potentiometer measures this angle
  double velocity = 0;  // rad/s
  // Torque (Nm) of the motor on the joint in the last step. Friction of the gear is included.
  double torque = 0;
  double current = 0;  // mean current through the motor over the last step, A
  double winding_celsius = 0;
  double case_celsius = 25;  // temperature of the motor's case
};

// Readings of an ideal inertial sensor at the robot's link `imu`, in the axes of that link. If the robot has
// no link `imu`, the sensor is at the root link's origin. The angular velocity is the value at the end of the
// last step. The specific force is the mean over the last step.
struct ImuState {
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s
  // Acceleration of the sensor minus the acceleration of gravity, m/s^2.
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();
};

// Contact point between two shapes.
struct ContactPoint {
  // Names of the two links in contact; for objects "model/link"
  std::string a, b;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();     // position in the world frame, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // force on `a`, N, world axes, mean over a step
};

// Convergence and failure of the solver since the start.
struct SolverDiagnostics {
  std::string failure;  // reason why step() stopped working, one sentence; empty if step() works
  std::int64_t unconverged_steps = 0;
  // Largest residual of a step: remaining velocity change, m/s or rad/s.
  double max_residual = 0;
  double first_s = 0, last_s = 0;  // times of the first and last unconverged step
  double drift = 0;                // sum of residual * step size over unconverged steps, m or rad
  // A drift up to this value (m or rad) is negligible. The value is far below the resolution of the
  // potentiometers.
  static constexpr double kNegligibleDrift = 1e-4;
  // Returns one sentence that says which steps did not converge, how large the error is, and whether the
  // result can be trusted. Returns an empty string if all steps converged.
  std::string summary() const;
};

struct WorldOptions {
  std::uint64_t seed = 1;
  double step_s = 0.001;  // step size, s; above 0, at most 0.01
  // Dynamics engine: "reduced" is ours; "exact" and "quickN" (N: 1 to 1000 iterations) are ODE's.
  std::string dynamics = "reduced";
  // True: suspended robot; the root link is fixed and the feet do not touch the ground.
  bool hung = false;
  ReadOptions reading = {};  // how World::load() reads the robot's file
  // Name of a motor in motor.xml, which is in the folder of the URDF file. "": the default motor of
  // motor.xml.
  std::string motor = "";
  bool ideal_motors = false;  // motors without backlash and heat
};

// Only one thread at a time may use a world. Different worlds may be used in different threads, even if one
// world is a clone of the other.
class World {
 public:
  // Loads a world (SDF), a robot (URDF), and motor.xml in the folder of the robot file. Fails if a file or an
  // option is invalid, or if the robot starts inside a model. For an invalid file, the error message contains
  // the line.
  static Result<std::unique_ptr<World>> load(const std::string& world_path,
                                             const std::string& robot_path,
                                             const WorldOptions& options);
  // Like load(), with the robot that load_robot() has read from `robot_path` with WorldOptions::reading.
  static Result<std::unique_ptr<World>> load_with(const RobotModel& robot,
                                                  const std::string& world_path,
                                                  const std::string& robot_path,
                                                  const WorldOptions& options);
  virtual ~World() = default;

  virtual double step_s() const = 0;
  virtual double time_s() const = 0;
  // Advances the world by step_s(). `drives` has one entry per joint, in joint order. If a joint has no
  // entry, the H-bridge of the joint's motor is open. `supply_volts` is the voltage of all motors whose drive
  // has no own supply. The function does nothing once diagnostics().failure is set.
  virtual void step(std::span<const MotorDrive> drives, double supply_volts) = 0;
  // The joints with a motor. Joints that follow another joint are not listed.
  virtual std::span<const JointState> joints() const = 0;
  virtual std::span<const std::string> joint_order() const = 0;  // names, in the order of joints()
  // Sum of the motors' supply currents in the last step, A.
  virtual double supply_current_a() const = 0;
  virtual const ImuState& imu() const = 0;
  // External contact forces on the robot's links in the last step, in the order of link_order(). Empty if
  // this world does not measure contact forces.
  virtual std::span<const LinkForce> link_forces() const { return {}; }
  virtual std::span<const std::string> link_order() const { return {}; }
  // joint_loads() returns the reaction forces in the joints in the last step, in joint order. The list is
  // empty unless watch_loads(true) was called before the step. Watching loads takes computing time but does
  // not change the motion.
  virtual void watch_loads(bool on) { static_cast<void>(on); }
  virtual std::span<const JointLoad> joint_loads() const { return {}; }

  virtual const Scene& scene() const = 0;
  virtual ScenePose pose() const = 0;
  // Returns the index of the head's frame in ScenePose::frames. The head is the link to which both links
  // `left_eye` and `right_eye` are fixed. If the robot has no such link, head_frame() returns -1. The optical
  // centers of the cameras are given in the head's frame (sim/render/camera.h).
  virtual int head_frame() const = 0;

  // The following functions return ground truth, for tests, measurements and evaluation only. All poses are
  // in the world frame.
  // Pose of a robot link's frame; identity if the robot has no link of this name.
  virtual Eigen::Isometry3d link_pose(const std::string& link) const = 0;
  // Position of the first link of a model. Fails if no model has this name.
  virtual Result<Eigen::Vector3d> object_position(const std::string& model) const = 0;
  virtual double largest_joint_gap_m() const = 0;  // largest joint constraint error since the start
  // Name of the engine, as in WorldOptions::dynamics.
  virtual std::string dynamics() const = 0;
  // Returns true if this kind of world counts unconverged steps in diagnostics().
  virtual bool measures_convergence() const { return false; }
  // Convergence and failure of the solver. ODE reports no residual, so worlds that use ODE set only
  // `failure`.
  virtual const SolverDiagnostics& diagnostics() const {
    static const SolverDiagnostics none;
    return none;
  }
  // contacts() returns the contacts of the last step. The list is empty unless watch_contacts(true) was
  // called before the step. Watching contacts takes computing time but does not change the motion.
  virtual void watch_contacts(bool on) { static_cast<void>(on); }
  virtual std::vector<ContactPoint> contacts() const { return {}; }

  // Applies an impulse (N s, world axes) to a link of the robot in the next step, at the link's center of
  // mass. For disturbance tests only. Fails if the robot has no link of this name, the link is fixed, or this
  // world does not support pushes.
  virtual Result<void> push(const std::string& link, const Eigen::Vector3d& impulse) {
    static_cast<void>(impulse);
    return fail(Fault::usage, "this world cannot push `" + link + "`; load one with World::load");
  }

  // Adds `change` (m/s, world axes) to the velocity of an object, like a short push through the object's
  // center of mass, and `spin` (rad/s, world axes) to its angular velocity. Fails if no object has this name,
  // the object is fixed, or this world does not support pushes.
  virtual Result<void> accelerate(const std::string& model, const Eigen::Vector3d& change,
                                  const Eigen::Vector3d& spin = Eigen::Vector3d::Zero()) {
    static_cast<void>(change);
    static_cast<void>(spin);
    return fail(Fault::usage, "this world cannot push `" + model + "`; load one with World::load");
  }

  // Returns a second world in the same state. With the same inputs, both worlds continue identically. The
  // worlds share only constant data (shapes, links, parameters). Either world may be destroyed first, and the
  // two worlds may be stepped in different threads. Cloning a world takes microseconds; loading a world takes
  // tens of milliseconds. Do not call clone() while another thread steps this world. Fails if this kind of
  // world cannot be cloned.
  virtual Result<std::unique_ptr<World>> clone() const {
    return fail(Fault::usage, "this kind of world cannot be cloned; load another one");
  }

  // Save and restore the state that is kept from step to step. Call restore() on a world that was built from
  // the same files and options as the saved world. For a kind of world that cannot be saved, both functions
  // set an error in the archive.
  virtual void save(StateWriter& to) { to.refuse("this kind of world cannot be saved"); }
  virtual void restore(StateReader& from) { from.refuse("this kind of world cannot be restored"); }
  // Identified servo of all motors, or null. Its control law belongs to the board or bus.
  virtual const servo_model::IdentifiedServo* servo() const { return nullptr; }
};

}  // namespace kaz::sim
