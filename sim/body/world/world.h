// The virtual world: the robot, what it stands on, and what it plays with. Rigid bodies, joints,
// motors and contacts; the robot is moved by its motors, gravity and contacts alone.
// SPDX-License-Identifier: Apache-2.0
//
// Units m, kg, s, rad, N. World frame: x forward from where the robot starts, y left, z up, ground
// at z = 0. Joint order: that of shared/board/joints.def for Kaz, that of the file for another robot.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "shared/base/result.hpp"
#include "sim/body/description/scene.h"
#include "sim/body/world/loads.h"
#include "sim/h8s/archive.h"

namespace kaz::sim {

// What a motor driver does to its motor during one step.
struct MotorDrive {
  double duty = 0;       // -1..1, mean over the step, positive turns the joint positively
  bool powered = false;  // false: the bridge is open, the motor turns freely but for friction
  // Faults of the gear (docs/faults.md).
  bool jammed = false;   // the joint stands where it is
  double slip_nm = 1e3;  // no more torque than this passes between motor and joint, Nm
};

struct JointState {
  double angle = 0;     // rad, of the output shaft, where the potentiometer sits
  double velocity = 0;  // rad/s
  double torque = 0;    // Nm, motor on the joint in the last step, friction included
  double current = 0;   // A, in the motor, mean over the last step
  double winding_celsius = 0;
};

// What an inertial sensor at the robot's link `imu` would measure if it were perfect, in the axes of
// that link; at the root's origin where the robot has no such link. Mean acceleration over the last
// step, velocity at its end.
struct ImuState {
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();    // acceleration minus gravity, m/s^2
};

// Where two shapes touch.
struct ContactPoint {
  std::string a, b;                                 // links; "model::link" in worlds
  Eigen::Vector3d at = Eigen::Vector3d::Zero();     // world frame, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on `a`, in the last step, N
};

// What makes a world's steps doubtful.
struct Trouble {
  std::string
      broken;  // why nothing goes on, in a sentence: steps do nothing any more; empty: it does
  std::int64_t unsettled = 0;  // steps so far that the solver left before it was done
  double worst = 0;  // m/s or rad/s, by which velocities still changed in the worst of them
  std::string sentence() const;  // of the unsettled steps, for people; empty where there are none
};

struct WorldOptions {
  std::uint64_t seed = 1;
  double step_s = 0.001;
  std::string stepper = "reduced";  // "reduced"; ODE: "exact", or "quickN" with N iterations
  bool hung = false;                // the robot's trunk is fixed, its feet well above the ground
  std::string motor =
      "";  // a motor of motor.xml, which stands beside the URDF; "": the file's default
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
  // A drive for each joint, in their order. Motors past the end of `drives` are open.
  virtual void step(std::span<const MotorDrive> drives, double supply_volts) = 0;
  virtual std::span<const JointState> joints() const = 0;
  virtual std::span<const std::string> joint_order() const = 0;  // names, as joints() has them
  virtual double supply_current_a() const = 0;  // sum of the motors' currents in the last step
  virtual const ImuState& imu() const = 0;
  // What touches the robot, by link in the order of link_order(): after each step, always.
  virtual std::span<const LinkForce> link_forces() const { return {}; }
  virtual std::span<const std::string> link_order() const { return {}; }
  // What the joints bore in the last step, in their order; empty if it was not watched in that step.
  // Watching changes nothing but time.
  virtual void watch_loads(bool on) { static_cast<void>(on); }
  virtual std::span<const JointLoad> joint_loads() const { return {}; }

  virtual const Scene& scene() const = 0;
  virtual ScenePose pose() const = 0;
  // Frame of the link that carries the eyes `left_eye` and `right_eye`, for the cameras: lens
  // centres are given in it (camera.h of sim/view). -1: the robot has no eyes.
  virtual int head_frame() const = 0;

  // Ground truth: for tests, figures and scoring only.
  virtual Eigen::Isometry3d link_pose(const std::string& link) const = 0;
  virtual Result<Eigen::Vector3d> object_position(const std::string& model) const = 0;
  virtual double largest_joint_gap_m() const = 0;  // since the start
  virtual std::string stepper() const = 0;
  // Since the start. ODE's steppers do not tell how far they are from done: theirs is `broken` alone.
  virtual const Trouble& trouble() const {
    static const Trouble none;
    return none;
  }
  // Contacts of the last step, if they were watched in it. Watching changes nothing but time.
  virtual void watch_contacts(bool on) { static_cast<void>(on); }
  virtual std::vector<ContactPoint> contacts() const { return {}; }

  // A push on a link of the robot at its centre of mass, N s in world axes, as a hand would give it: it
  // acts in the next step. For tests of disturbance only. Errors: no such link, or it cannot move; this
  // kind of world knows no pushes.
  virtual Result<void> push(const std::string& link, const Eigen::Vector3d& impulse) {
    static_cast<void>(impulse);
    return fail(Fault::usage, "this world cannot push `" + link + "`; load one with World::load");
  }

  // All that goes on from step to step, for a world made of the same files and options. The
  // archive fails where a kind of world cannot.
  virtual void save(h8s::StateWriter& to) { to.refuse("this kind of world cannot be saved"); }
  virtual void restore(h8s::StateReader& from) {
    from.refuse("this kind of world cannot be restored");
  }
};

}  // namespace kaz::sim
