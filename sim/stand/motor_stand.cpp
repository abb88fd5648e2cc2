// Motor stand: the discs' dynamics, and the tools.
// SPDX-License-Identifier: Apache-2.0
#include "sim/stand/motor_stand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/base/random.hpp"
#include "shared/board/table.h"
#include "sim/body/description/joint_names.h"
#include "sim/body/motor/stop_margin.h"

namespace kaz::sim {
namespace {

constexpr double kHandStiffness = 60;  // Nm/rad, of a hand that turns a shaft
constexpr double kHandDamping = 0.5;   // Nm s/rad, of that, and of one that lays a weight on
constexpr double kHandSpeed = 2;       // rad/s
constexpr double kScaleNoise = 2e-3;   // Nm
constexpr double kScaleResolution = 1e-3;
constexpr double kProtractor = 0.01 * std::numbers::pi / 180;

double in_steps(double value, double step) {
  return step * std::round(value / step);
}

}  // namespace

MotorStand::MotorStand(const StandOptions& options)
    : options_(options),
      shafts_(KZ_JOINTS),
      motors_(KZ_JOINTS, JointMotor(options.motor, options.step_s)),
      states_(KZ_JOINTS) {
  scene_.frames = {"world"};
  imu_.specific_force = {0, 0, 9.81};
  for (std::size_t j = 0; j < KZ_JOINTS; ++j)
    states_[j].winding_celsius = motors_[j].winding_celsius();
}

std::span<const std::string> MotorStand::joint_order() const {
  return joint_names();
}

Eigen::Isometry3d MotorStand::link_pose(const std::string&) const {
  return Eigen::Isometry3d::Identity();
}

Result<Eigen::Vector3d> MotorStand::object_position(const std::string& model) const {
  return fail(Fault::usage, "there is no object `" + model + "`: a motor stand has no objects");
}

void MotorStand::clamp(std::size_t joint, bool on) {
  Shaft& shaft = shafts_[joint];
  shaft.clamped = on;
  shaft.count = 0;
}

double MotorStand::scale_nm(std::size_t joint) const {
  const Shaft& shaft = shafts_[joint];
  if (shaft.count == 0) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < shaft.count; ++i) sum += shaft.pressed[i];
  // Repeated readings of one measurement are equal.
  const double noise =
      keyed_normal(options_.seed, static_cast<std::uint64_t>(shaft.pressed_at), 100 + joint);
  return in_steps(sum / shaft.count + kScaleNoise * noise, kScaleResolution);
}

void MotorStand::press(std::size_t joint, double torque_nm) {
  shafts_[joint].press_nm = torque_nm;
  shafts_[joint].pressing = torque_nm != 0;
}

void MotorStand::turn(std::size_t joint, double angle_rad) {
  Shaft& shaft = shafts_[joint];
  if (!shaft.guided) shaft.guide_rad = states_[joint].angle;
  shaft.guided = true;
  shaft.goal_rad = angle_rad;
}

void MotorStand::release(std::size_t joint) {
  shafts_[joint].guided = false;
}

int MotorStand::free_all() {
  int freed = 0;
  for (std::size_t joint = 0; joint < shafts_.size(); ++joint) {
    const Shaft& shaft = shafts_[joint];
    if (!shaft.clamped && !shaft.pressing && !shaft.guided) continue;
    ++freed;
    clamp(joint, false);
    press(joint, 0);
    release(joint);
  }
  return freed;
}

double MotorStand::protractor_rad(std::size_t joint) const {
  return in_steps(states_[joint].angle, kProtractor);
}

void MotorStand::guide(Shaft& shaft) const {
  const double max_step = kHandSpeed * options_.step_s;
  shaft.guide_rad += std::clamp(shaft.goal_rad - shaft.guide_rad, -max_step, max_step);
}

void MotorStand::step_shaft(std::size_t joint, const MotorDrive& drive, double supply_volts) {
  const double h = options_.step_s;
  Shaft& shaft = shafts_[joint];
  JointState& state = states_[joint];
  JointMotor& motor = motors_[joint];
  const JointMotor::Row row = motor.prepare(drive, supply_volts, state.angle, state.velocity);

  double mass = options_.disc_kgm2 / h;
  double push = mass * state.velocity;
  if (shaft.pressing || shaft.guided) mass += kHandDamping;
  if (shaft.pressing) push += shaft.press_nm;
  if (shaft.guided) {
    guide(shaft);
    mass += kHandStiffness * h;
    push += kHandStiffness * (shaft.guide_rad - state.angle);
  }
  const auto torque_at = [&row](double velocity, double yield) {
    return std::clamp((row.velocity - velocity) / (row.softness + yield), row.min, row.max);
  };
  double torque = torque_at(push / mass, 1 / mass);
  double velocity = (push + torque) / mass;
  const double lower = 1e-4 * kz_board_joints[joint].lower - kStopMargin;
  const double upper = 1e-4 * kz_board_joints[joint].upper + kStopMargin;
  const double held =
      shaft.clamped ? 0
                    : std::clamp(velocity, (lower - state.angle) / h, (upper - state.angle) / h);
  if (held != velocity) {
    velocity = held;
    torque = torque_at(velocity, 0);
  }
  if (shaft.clamped && drive.powered && drive.duty != 0) {
    shaft.next = (shaft.next + 1) % kScaleSteps;
    shaft.pressed[shaft.next] = torque;
    shaft.pressed_at = steps_;
    shaft.count = std::min<std::uint32_t>(shaft.count + 1, kScaleSteps);
  }
  motor.finish(velocity, torque);
  state.velocity = velocity;
  state.angle += h * velocity;
  state.torque = torque;
  state.current = motor.motor_current();
  state.winding_celsius = motor.winding_celsius();
  current_ += motor.supply_current();
}

void MotorStand::step(std::span<const MotorDrive> drives, double supply_volts) {
  ++steps_;
  current_ = 0;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    step_shaft(j, j < drives.size() ? drives[j] : MotorDrive{}, supply_volts);
  }
}

}  // namespace kaz::sim
