// Base of all worlds, independent of the solver.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/world/staged_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kaz::sim {
namespace {

// The motor of each joint, with the joint's own friction, damping and effort limit. A joint that follows
// another joint acts through the coupling: its friction counts |ratio| times, its damping ratio^2 times.
std::vector<JointMotor> motors_of(const RobotModel& robot, const MotorParams& motor,
                                  double step_s) {
  std::vector<MotorParams> all;
  for (const RobotJoint& joint : robot.joints) {
    const double ratio = joint.follows ? joint.follows->ratio : 1;
    if (!joint.follows) all.push_back(motor);
    MotorParams& own =
        joint.follows ? all[static_cast<std::size_t>(joint.follows->joint)] : all.back();
    own.friction_nm += std::abs(ratio) * joint.friction;
    own.damping_nms_per_rad += ratio * ratio * joint.damping;
  }
  std::vector<JointMotor> motors;
  for (std::size_t i = 0; i < all.size(); ++i) {
    // The limit is that of the shaft, and friction takes its part of the drive torque.
    all[i].max_drive_nm =
        std::min(all[i].max_drive_nm, robot.joints[i].effort + all[i].friction_nm);
    motors.emplace_back(all[i], step_s);
  }
  return motors;
}

}  // namespace

StagedWorld::StagedWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                         const WorldOptions& options)
    : model_(std::make_shared<const StageModel>(world, robot, options)),
      step_s_(options.step_s),
      gravity_(world.gravity),
      hung_(options.hung && !robot.fixed_base),
      robot_links_(robot.links.size()),
      kicks_left_(model_->kicks.size()),
      pushes_left_(model_->pushes.size()),
      motors_(motors_of(robot, motor, options.step_s)),
      rows_(robot.motors()),
      servo_(motor.servo),
      external_nm_(robot.motors(), 0.0),
      joint_states_(robot.motors()),
      link_forces_(robot.links.size()) {
  if (const auto imu = model_->link_frames.find("imu"); imu != model_->link_frames.end())
    imu_frame_ = imu->second;
}

Eigen::Isometry3d StagedWorld::body_pose(int body) const {
  const Body& info = bodies()[static_cast<std::size_t>(body)];
  return info.moves ? moving_pose(body) : info.start;
}

bool StagedWorld::has_stepped() const {
  return std::ranges::any_of(model_->feet, [this](int foot) {
    const double start = bodies()[static_cast<std::size_t>(foot)].start.translation().z();
    return body_pose(foot).translation().z() > start + kFirstStep;
  });
}

void StagedWorld::kick_due() {
  take_due(model_->kicks, kicks_left_, steps_);
  if (pushes_left_ == 0) return;
  if (first_step_ < 0 && has_stepped()) first_step_ = steps_;
  if (first_step_ >= 0) take_due(model_->pushes, pushes_left_, steps_ - first_step_);
}

void StagedWorld::take_due(const std::vector<StageModel::Kick>& kicks, std::size_t& left,
                           std::int64_t step) {
  for (; left > 0; --left) {
    const StageModel::Kick& next = kicks[left - 1];
    if (next.step > step) return;
    if (static_cast<std::size_t>(next.body) < robot_links_) {
      hand_pushes_.push_back({static_cast<std::uint32_t>(next.body), next.change});
    } else {
      kick(next.body, next.change, Eigen::Vector3d::Zero());
    }
  }
}

Result<void> StagedWorld::push(const std::string& link, const Eigen::Vector3d& impulse) {
  const auto frame = model_->link_frames.find(link);
  if (frame == model_->link_frames.end()) {
    return fail(Fault::usage, "the robot has no link `" + link + "` to push");
  }
  const int body = frame->second.link;
  if (!bodies()[static_cast<std::size_t>(body)].moves || (hung_ && body == 0)) {
    return fail(Fault::usage, "the link `" + link + "` is fixed: a push cannot move it");
  }
  if (!impulse.allFinite()) {
    return fail(Fault::usage, "push on `" + link + "`: the impulse in N s must be finite");
  }
  hand_pushes_.push_back({static_cast<std::uint32_t>(body), impulse});
  return {};
}

Result<void> StagedWorld::accelerate(const std::string& model, const Eigen::Vector3d& change,
                                     const Eigen::Vector3d& spin) {
  const auto object = model_->objects.find(model);
  if (object == model_->objects.end() ||
      !bodies()[static_cast<std::size_t>(object->second)].moves) {
    return fail(Fault::usage, "the world has no movable object `" + model + "`");
  }
  if (!change.allFinite() || !spin.allFinite()) {
    return fail(Fault::usage,
                "push on `" + model + "`: the velocities in m/s and rad/s must be finite");
  }
  kick(object->second, change, spin);
  return {};
}

void StagedWorld::prepare_motors(std::span<const MotorDrive> drives, double supply_volts) {
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const MotorDrive drive = i < drives.size() ? drives[i] : MotorDrive{};
    rows_[i] = motors_[i].prepare(drive, drive.supply_volts.value_or(supply_volts),
                                  joint_states_[i].angle, joint_states_[i].velocity);
  }
}

void StagedWorld::break_down(const std::string& why) {
  if (!diagnostics_.failure.empty()) return;
  char when[32];
  std::snprintf(when, sizeof when, "%.3f s", static_cast<double>(steps_) * step_s_);
  diagnostics_.failure = "the physics broke down at " + std::string(when) + ": " + why +
                         "; check masses, inertias and motors of the model";
}

bool StagedWorld::drives_are_numbers() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const JointMotor::Row& row = rows_[i];
    if (std::isfinite(row.velocity) && row.softness > 0) continue;
    break_down("the drive of joint `" + model_->joint_order[i] + "` is not a number");
    return false;
  }
  return true;
}

bool StagedWorld::joint_can_turn(const std::string& joint, double velocity) {
  if (std::abs(velocity) * step_s_ <= kMaxTurn) return true;
  char speed[48];
  std::snprintf(speed, sizeof speed, "` turns at %.3g rad/s", velocity);
  break_down("joint `" + joint + speed + ", which is too fast for the physics step");
  return false;
}

bool StagedWorld::body_can_move(std::size_t body, const Eigen::Vector3d& velocity,
                                const Eigen::Vector3d& angular) {
  if (velocity.norm() * step_s_ <= kMaxTravel && angular.norm() * step_s_ <= kMaxTurn) return true;
  char speed[96];
  std::snprintf(speed, sizeof speed, "` moves at %.3g m/s and turns at %.3g rad/s", velocity.norm(),
                angular.norm());
  break_down("link `" + bodies()[body].rigid.name + speed +
             ", which is too fast for the physics step");
  return false;
}

void StagedWorld::finish_motors() {
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    motors_[i].finish(joint_states_[i].velocity, joint_states_[i].torque, external_nm_[i]);
  }
  read_motors();
}

void StagedWorld::read_motors() {
  current_ = 0;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    joint_states_[i].winding_celsius = motors_[i].winding_celsius();
    joint_states_[i].case_celsius = motors_[i].case_celsius();
    joint_states_[i].current = motors_[i].motor_current();
    current_ += motors_[i].supply_current();
  }
}

ScenePose StagedWorld::pose() const {
  ScenePose pose;
  pose.frames.reserve(model_->frames.size() + 1);
  pose.frames.push_back(Eigen::Isometry3d::Identity());
  for (const int body : model_->frames) pose.frames.push_back(body_pose(body));
  return pose;
}

Eigen::Isometry3d StagedWorld::link_pose(const std::string& link) const {
  const auto frame = model_->link_frames.find(link);
  if (frame == model_->link_frames.end()) return Eigen::Isometry3d::Identity();
  return body_pose(frame->second.link) * frame->second.in_link;
}

Result<Eigen::Vector3d> StagedWorld::object_position(const std::string& model) const {
  if (const auto object = model_->objects.find(model); object != model_->objects.end()) {
    return Eigen::Vector3d(body_pose(object->second).translation());
  }
  if (const auto object = model_->fixed_objects.find(model);
      object != model_->fixed_objects.end()) {
    return Eigen::Vector3d(object->second.translation());
  }
  std::string known;
  for (const auto& [name, body] : model_->objects) {
    if (!known.empty()) known += ", ";
    known += name;
  }
  return fail(Fault::usage, "the world has no object `" + model +
                                "`; movable objects: " + (known.empty() ? "none" : known));
}

}  // namespace kaz::sim
