// Base of all worlds, independent of the solver.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/world/staged_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kaz::sim {
namespace {

constexpr double kHungHeight = 0.5;  // m, of the feet above the ground

}  // namespace

StagedWorld::StagedWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                         const WorldOptions& options)
    : step_s_(options.step_s),
      gravity_(world.gravity),
      hung_(options.hung && !robot.fixed_base),
      robot_links_(robot.links.size()),
      contacts_(robot),
      motors_(robot.joints.size(), JointMotor(motor, options.step_s)),
      rows_(robot.joints.size()),
      joint_states_(robot.joints.size()),
      link_forces_(robot.links.size()),
      joint_order_(robot.joint_order()),
      link_frames_(robot.frames) {
  scene_.frames.push_back("world");
  scene_.light = world.light;
  // The root's origin starts above the point between the soles, so that the feet are at height `feet`.
  const double feet = options.hung ? kHungHeight : 0.0;
  const Eigen::AlignedBox3d extent = robot.extent();
  Eigen::Vector3d lift = Eigen::Vector3d::Zero();
  if (!robot.fixed_base) lift.z() = feet - (extent.isEmpty() ? 0.0 : extent.min().z());
  add_robot(robot, world.robot_start * Eigen::Translation3d(lift));
  for (const WorldBody& object : world.bodies) add_object(object);
  // Latest first: the next kick is popped from the end; equal times keep the order of the file.
  std::reverse(kicks_.begin(), kicks_.end());
  std::stable_sort(kicks_.begin(), kicks_.end(),
                   [](const Kick& a, const Kick& b) { return a.step > b.step; });
  all_kicks_ = kicks_;
}

int StagedWorld::add_frame(const std::string& name, int body) {
  frames_.push_back(body);
  scene_.frames.push_back(name);
  return static_cast<int>(scene_.frames.size()) - 1;
}

void StagedWorld::add_visuals(const RigidLink& link, int frame, const Eigen::Isometry3d& in_frame) {
  for (Visual visual : link.visuals) {
    visual.frame = frame;
    visual.in_frame = in_frame * visual.in_frame;
    scene_.visuals.push_back(std::move(visual));
  }
}

int StagedWorld::add_body(const RigidLink& link, const Eigen::Isometry3d& start, bool moves) {
  Body body{link, moves, start};
  body.rigid.visuals.clear();
  body.rigid.collisions.clear();
  bodies_.push_back(std::move(body));
  return static_cast<int>(bodies_.size()) - 1;
}

void StagedWorld::add_robot(const RobotModel& robot, const Eigen::Isometry3d& root) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const RobotLink& link = robot.links[i];
    const Eigen::Isometry3d at = root * link.at_zero;
    const bool moves = i > 0 || !robot.fixed_base;
    const int body = add_body(link.rigid, at, moves);
    contacts_.add_robot_link(link.rigid, static_cast<int>(i), moves ? body : -1, at);
    const int frame = add_frame(link.rigid.name, body);
    link_order_.push_back(link.rigid.name);
    add_visuals(link.rigid, frame, Eigen::Isometry3d::Identity());
    if (robot.eyes_link() == static_cast<int>(i)) head_frame_ = frame;
  }
  if (const auto imu = link_frames_.find("imu"); imu != link_frames_.end())
    imu_frame_ = imu->second;
}

void StagedWorld::add_object(const WorldBody& object) {
  if (object.fixed) {
    contacts_.add_object(object.rigid, -1, object.pose);
    add_visuals(object.rigid, 0, object.pose);
    fixed_objects_.emplace(object.model, object.pose);
    return;
  }
  const int body = add_body(object.rigid, object.pose, true);
  contacts_.add_object(object.rigid, body, object.pose);
  add_visuals(object.rigid, add_frame(object.rigid.name, body), Eigen::Isometry3d::Identity());
  objects_.emplace(object.model, body);
  for (const sim::Kick& kick : object.kicks) {
    kicks_.push_back({std::llround(kick.time_s / step_s_), body, kick.velocity});
  }
}

Eigen::Isometry3d StagedWorld::body_pose(int body) const {
  const Body& info = bodies_[static_cast<std::size_t>(body)];
  return info.moves ? moving_pose(body) : info.start;
}

void StagedWorld::kick_due() {
  while (!kicks_.empty() && kicks_.back().step <= steps_) {
    kick(kicks_.back().body, kicks_.back().velocity);
    kicks_.pop_back();
  }
}

Result<void> StagedWorld::push(const std::string& link, const Eigen::Vector3d& impulse) {
  const auto frame = link_frames_.find(link);
  if (frame == link_frames_.end()) {
    return fail(Fault::usage, "the robot has no link `" + link + "` to push");
  }
  const int body = frame->second.link;
  if (!bodies_[static_cast<std::size_t>(body)].moves || (hung_ && body == 0)) {
    return fail(Fault::usage, "the link `" + link + "` is fixed: no push moves it");
  }
  if (!impulse.allFinite()) {
    return fail(Fault::usage, "a push on `" + link + "` has no finite impulse, N s");
  }
  hand_pushes_.push_back({static_cast<std::uint32_t>(body), impulse});
  return {};
}

void StagedWorld::prepare_motors(std::span<const MotorDrive> drives, double supply_volts) {
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const MotorDrive drive = i < drives.size() ? drives[i] : MotorDrive{};
    rows_[i] =
        motors_[i].prepare(drive, supply_volts, joint_states_[i].angle, joint_states_[i].velocity);
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
    break_down("the drive of joint `" + joint_order_[i] + "` is not a number");
    return false;
  }
  return true;
}

bool StagedWorld::joint_can_turn(std::size_t joint, double velocity) {
  if (std::abs(velocity) * step_s_ <= kMaxTurn) return true;
  char speed[48];
  std::snprintf(speed, sizeof speed, "` turns at %.3g rad/s", velocity);
  break_down("joint `" + joint_order_[joint] + speed + ", more than a step can follow");
  return false;
}

bool StagedWorld::body_can_move(std::size_t body, const Eigen::Vector3d& velocity,
                                const Eigen::Vector3d& angular) {
  if (velocity.norm() * step_s_ <= kMaxTravel && angular.norm() * step_s_ <= kMaxTurn) return true;
  char speed[96];
  std::snprintf(speed, sizeof speed, "` moves at %.3g m/s and turns at %.3g rad/s", velocity.norm(),
                angular.norm());
  break_down("link `" + bodies_[body].rigid.name + speed + ", more than a step can follow");
  return false;
}

void StagedWorld::finish_motors() {
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    motors_[i].finish(joint_states_[i].velocity, joint_states_[i].torque);
  }
  read_motors();
}

void StagedWorld::read_motors() {
  current_ = 0;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    joint_states_[i].winding_celsius = motors_[i].winding_celsius();
    joint_states_[i].current = motors_[i].motor_current();
    current_ += motors_[i].supply_current();
  }
}

ScenePose StagedWorld::pose() const {
  ScenePose pose;
  pose.frames.reserve(frames_.size() + 1);
  pose.frames.push_back(Eigen::Isometry3d::Identity());
  for (const int body : frames_) pose.frames.push_back(body_pose(body));
  return pose;
}

Eigen::Isometry3d StagedWorld::link_pose(const std::string& link) const {
  const auto frame = link_frames_.find(link);
  if (frame == link_frames_.end()) return Eigen::Isometry3d::Identity();
  return body_pose(frame->second.link) * frame->second.in_link;
}

Result<Eigen::Vector3d> StagedWorld::object_position(const std::string& model) const {
  if (const auto object = objects_.find(model); object != objects_.end()) {
    return Eigen::Vector3d(body_pose(object->second).translation());
  }
  if (const auto object = fixed_objects_.find(model); object != fixed_objects_.end()) {
    return Eigen::Vector3d(object->second.translation());
  }
  std::string known;
  for (const auto& [name, body] : objects_) {
    if (!known.empty()) known += ", ";
    known += name;
  }
  return fail(Fault::usage, "the world has no object `" + model +
                                "`; those that can move: " + (known.empty() ? "none" : known));
}

}  // namespace kaz::sim
