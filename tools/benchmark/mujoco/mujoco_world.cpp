// The robot and the other bodies in MuJoCo.
// SPDX-License-Identifier: Apache-2.0
#include "tools/benchmark/mujoco/mujoco_world.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "tools/benchmark/mujoco/mujoco_model.h"

namespace kaz::sim::bench {
namespace {

constexpr int kExemptGenerations = 3;  // as contact_model.cpp
constexpr const char* kFile = "kaz.xml";

std::string compile_error(const char* reason) {
  return std::string("MuJoCo rejects the robot's model: ") + reason;
}

}  // namespace

Result<std::unique_ptr<World>> MujocoWorld::load(const std::string& world_path,
                                                 const std::string& robot_path,
                                                 const WorldOptions& options) {
  const auto files = KAZ_TRY(read_world_files(world_path, robot_path, options));
  return make(files.world, files.robot, files.motor, options, {});
}

Result<std::unique_ptr<World>> MujocoWorld::make(const WorldModel& world, const RobotModel& robot,
                                                 const MotorParams& motor,
                                                 const WorldOptions& options,
                                                 MujocoSettings settings) {
  const bool slides =
      std::ranges::any_of(robot.joints, [](const RobotJoint& joint) { return joint.pinion_m > 0; });
  if (slides || robot.motors() != robot.joints.size() || !world.joints.empty())
    return fail(Fault::usage,
                "the MuJoCo model has no prismatic joints, no joints that follow others, and no "
                "joints of worlds; give a robot and a world without them");
  std::unique_ptr<MujocoWorld> made(new MujocoWorld(world, robot, motor, options));
  KAZ_TRY(made->compile(world, robot, settings));
  return made;
}

MujocoWorld::MujocoWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
                         const WorldOptions& options)
    : StagedWorld(world, robot, motor, options), motor_(motor) {}

Result<void> MujocoWorld::compile(const WorldModel& world, const RobotModel& robot,
                                  MujocoSettings settings) {
  settings.step_s = step_s_;
  settings.fixed_base = hung_ || robot.fixed_base;
  settings.stop_margin_rad = kStopMargin;
  settings.exempt_generations = kExemptGenerations;
  const std::string text = mujoco_model(world, robot, motor_, bodies()[0].start, settings);
  const auto files = std::make_unique<mjVFS>();  // some megabytes
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), kFile, static_cast<int>(text.size()));
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), kFile)], text.data(), text.size());
  std::array<char, 1000> reason{};
  mujoco_.reset(mj_loadXML(kFile, files.get(), reason.data(), static_cast<int>(reason.size())));
  mj_deleteVFS(files.get());
  if (!mujoco_) return fail(Fault::failed, compile_error(reason.data()));
  data_.reset(mj_makeData(mujoco_.get()));
  for (std::size_t body = 0; body < bodies().size(); ++body) {
    const std::string name = body < robot_links_ ? "link" + std::to_string(body)
                                                 : "body" + std::to_string(body - robot_links_);
    body_ids_.push_back(mj_name2id(mujoco_.get(), mjOBJ_BODY, name.c_str()));
  }
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
    const int id =
        mj_name2id(mujoco_.get(), mjOBJ_JOINT, ("joint" + std::to_string(joint)).c_str());
    angle_at_.push_back(mujoco_->jnt_qposadr[id]);
    velocity_at_.push_back(mujoco_->jnt_dofadr[id]);
  }
  mj_forward(mujoco_.get(), data_.get());
  imu_by_differences_.start(body_pose(imu_frame_.link) * imu_frame_.in_link);
  return {};
}

Eigen::Isometry3d MujocoWorld::moving_pose(int body) const {
  const int id = body_ids_[static_cast<std::size_t>(body)];
  const mjtNum* at = data_->xpos + 3 * id;
  const mjtNum* q = data_->xquat + 4 * id;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(at[0], at[1], at[2]);
  pose.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  return pose;
}

void MujocoWorld::kick(int body, const Eigen::Vector3d& velocity, const Eigen::Vector3d& spin) {
  const int id = body_ids_[static_cast<std::size_t>(body)];
  mjtNum* to = data_->qvel + mujoco_->jnt_dofadr[mujoco_->body_jntadr[id]];
  // MuJoCo's angular velocity of a free joint is in the body's axes.
  const Eigen::Vector3d own = moving_pose(body).linear().transpose() * spin;
  for (int k = 0; k < 3; ++k) {
    to[k] += velocity[k];
    to[3 + k] += own[k];
  }
}

void MujocoWorld::push_links() {
  std::fill_n(data_->xfrc_applied, 6 * mujoco_->nbody, 0);
  for (const HandPush& push : hand_pushes_)
    for (int k = 0; k < 3; ++k)
      data_->xfrc_applied[6 * body_ids_[push.link] + k] += push.impulse[k] / step_s_;
  hand_pushes_.clear();
}

void MujocoWorld::step(std::span<const MotorDrive> drives, double supply_volts) {
  kick_due();
  push_links();
  const double volts = std::min(supply_volts, motor_.max_supply_v);
  for (std::size_t i = 0; i < velocity_at_.size(); ++i) {
    // The motor line at stall; damping and frictionloss have the rest. An open bridge has no back-EMF.
    const double duty = drives[i].powered ? std::clamp(drives[i].duty, -1.0, 1.0) : 0.0;
    data_->qfrc_applied[velocity_at_[i]] = motor_.stall_slope_nm_per_v * volts * duty;
    mujoco_->dof_damping[velocity_at_[i]] = drives[i].powered ? motor_.back_emf_nms_per_rad : 0.0;
  }
  mj_step(mujoco_.get(), data_.get());
  ++steps_;
  read_joints();
  imu_ =
      imu_by_differences_.read(body_pose(imu_frame_.link) * imu_frame_.in_link, step_s_, gravity_);
}

void MujocoWorld::read_joints() {
  for (std::size_t i = 0; i < joint_states_.size(); ++i) {
    joint_states_[i].angle = data_->qpos[angle_at_[i]];
    joint_states_[i].velocity = data_->qvel[velocity_at_[i]];
    joint_states_[i].torque =
        data_->qfrc_applied[velocity_at_[i]] + data_->qfrc_passive[velocity_at_[i]];
  }
}

int MujocoWorld::find_contacts() {
  mj_fwdPosition(mujoco_.get(), data_.get());
  return data_->ncon;
}

}  // namespace kaz::sim::bench
