// Virtual motor stand, used instead of a robot. Each of the board's motors turns its own disc.
// SPDX-License-Identifier: Apache-2.0
//
// The stand has the tools for manual measurements. A lever clamps the shaft and presses on a scale. A weight
// applies a torque to the shaft. A hand turns the shaft to an angle that a protractor shows. A knob sets the
// supply voltage.
//
// Each motor has one body with one degree of freedom, so the step is solved in closed form. The motor model
// (joint_motor.h) and the step size are the same as for a robot. This equation determines w1, the speed after
// the step:
//
//   (I/h + c + k h) w1 = I/h w0 + k e + load + T,   T = (velocity - w1) / softness within its bounds
//
// `I` is the disc's inertia (kg m^2), and `h` is the step size (s). The speeds before and after the step are
// w0 and w1 (rad/s). The hand acts on the shaft like a spring with the stiffness k (Nm/rad) and the damping c
// (Nm s/rad). The angle e (rad) is the angle of the hand minus the angle of the shaft. `load` is the torque
// of the weight, and T is the torque of the motor (Nm). The shafts have the mechanical stops of Kaz's joints.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/body/motor/joint_motor.h"
#include "sim/body/world/world.h"

namespace kaz::sim {

struct StandOptions {
  MotorParams motor;
  double disc_kgm2 = 4e-4;  // aluminum, 120 mm in diameter, 7 mm thick
  double step_s = 0.001;
  std::uint64_t seed = 1;  // seed of the scale's random noise
  // Open-circuit voltage at the start. make_stand() uses SimulationOptions::supply_volts instead.
  double supply_volts = 10;
};

class MotorStand final : public World {
 public:
  explicit MotorStand(const StandOptions& options);

  double disc_kgm2() const { return options_.disc_kgm2; }
  const MotorParams& motor() const { return options_.motor; }
  double first_supply_volts() const { return options_.supply_volts; }

  // Tools. `joint` is the number of the board's channel to which the motor is connected. If `on` is true,
  // clamps the shaft with a lever that presses on a scale. If `on` is false, removes the lever. Each call of
  // clamp() resets the scale to zero.
  void clamp(std::size_t joint, bool on);
  // Returns the reading of the scale: the torque of the motor, Nm. A torque in the joint's positive
  // direction is positive. The reading is the mean over the last 50 steps in which the motor was driven
  // against the clamp. The scale keeps this reading when the motor stops. Before the first reading, the
  // scale shows 0. The noise has a sigma of 2 mNm, the resolution is 1 mNm.
  double scale_nm(std::size_t joint) const;
  // Applies the torque of a weight, `torque_nm`, to the shaft without a shock. A torque of 0 removes the
  // weight.
  void press(std::size_t joint, double torque_nm);
  // Turns the shaft by hand to `angle_rad` at 2 rad/s and holds the shaft until release().
  void turn(std::size_t joint, double angle_rad);
  void release(std::size_t joint);
  // Removes lever, weight and hand from every shaft. Returns the number of shafts from which a lever, a
  // weight or a hand was removed.
  int free_all();
  // Returns the angle that the protractor shows, rad. The resolution is 0.01 degrees.
  double protractor_rad(std::size_t joint) const;

  double step_s() const override { return options_.step_s; }
  double time_s() const override { return static_cast<double>(steps_) * options_.step_s; }
  void step(std::span<const MotorDrive> drives, double supply_volts) override;
  std::span<const JointState> joints() const override { return states_; }
  std::span<const std::string> joint_order() const override;
  double supply_current_a() const override { return current_; }
  const ImuState& imu() const override { return imu_; }
  const Scene& scene() const override { return scene_; }
  ScenePose pose() const override { return {{Eigen::Isometry3d::Identity()}}; }
  int head_frame() const override { return -1; }
  Eigen::Isometry3d link_pose(const std::string& link) const override;
  Result<Eigen::Vector3d> object_position(const std::string& model) const override;
  double largest_joint_gap_m() const override { return 0; }
  std::string dynamics() const override { return "stand"; }
  const SolverDiagnostics& diagnostics() const override { return diagnostics_; }
  void save(StateWriter& to) override { transfer(to); }
  void restore(StateReader& from) override { transfer(from); }
  Result<std::unique_ptr<World>> clone() const override {
    return std::make_unique<MotorStand>(*this);
  }

 private:
  static constexpr std::size_t kScaleSteps = 50;  // number of steps over which the scale averages
  struct Shaft {
    bool clamped = false, guided = false, pressing = false;
    double press_nm = 0, goal_rad = 0, guide_rad = 0;
    // Ring buffer of the scale, Nm. The newest value is at the index `next`.
    std::array<double, kScaleSteps> pressed{};
    std::uint32_t next = 0, count = 0;
    std::int64_t pressed_at = 0;  // number of the step that stored the newest value
    template <class A>
    void transfer(A& a) {
      a(clamped, guided, pressing, press_nm, goal_rad, guide_rad, pressed, next, count, pressed_at);
      a.require(next < kScaleSteps && count <= kScaleSteps, "scale");
    }
  };
  void step_shaft(std::size_t joint, const MotorDrive& drive, double supply_volts);
  void guide(Shaft& shaft) const;
  template <class A>
  void transfer(A& a) {
    a(steps_, current_, shafts_);
    a.require(shafts_.size() == motors_.size(), "number of shafts");
    for (JointMotor& motor : motors_) a(motor);
    for (JointState& s : states_) a(s.angle, s.velocity, s.torque, s.current, s.winding_celsius);
  }

  StandOptions options_;
  std::int64_t steps_ = 0;
  double current_ = 0;
  std::vector<Shaft> shafts_;
  std::vector<JointMotor> motors_;
  std::vector<JointState> states_;
  ImuState imu_;
  Scene scene_;
  SolverDiagnostics diagnostics_;
};

}  // namespace kaz::sim
