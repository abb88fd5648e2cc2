// Robot and other bodies in MuJoCo, only for the dynamics benchmark and for tests.
// SPDX-License-Identifier: Apache-2.0
//
// Files, masses, shapes, motor model and position loops are the same as for the other steppers. The solver is
// Newton's method on MuJoCo's convex model of contacts, with elliptic cones. Differences from the other
// steppers:
// - Contacts and stops are modeled by MuJoCo's springs and dampers (mujoco_model.cpp).
// - The friction coefficient of a contact is the larger coefficient of the two surfaces.
// - The gear has no backlash.
// - The simulation of resting bodies is never suspended, because Debian's version of MuJoCo has no islands.
// All poses are from the beginning of the last step, because mj_step() does not update the poses after the
// step.
#pragma once

#include <memory>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/body/world/staged_world.h"
#include "tools/benchmark/common/imu_by_differences.h"
#include "tools/benchmark/mujoco/mujoco_model.h"

namespace kaz::sim::bench {

class MujocoWorld final : public StagedWorld {
 public:
  // Loads the files like World::load(). Returns Fault::failed if MuJoCo rejects the model. Other errors come
  // from reading the files.
  static Result<std::unique_ptr<World>> load(const std::string& world_path,
                                             const std::string& robot_path,
                                             const WorldOptions& options);
  // Builds the world of models that are already in memory. Only MujocoSettings::solref is taken from
  // `settings`. Returns Fault::failed if MuJoCo rejects the model.
  static Result<std::unique_ptr<World>> make(const WorldModel& world, const RobotModel& robot,
                                             const MotorParams& motor, const WorldOptions& options,
                                             MujocoSettings settings);

  void step(std::span<const MotorDrive> drives, double supply_volts) override;
  int find_contacts() override;
  // Always 0, because MuJoCo uses reduced coordinates.
  double largest_joint_gap_m() const override { return 0; }
  std::string dynamics() const override { return "mujoco"; }

 private:
  struct DeleteModel {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
  };
  struct DeleteData {
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  using ModelPtr = std::unique_ptr<mjModel, DeleteModel>;

  MujocoWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
              const WorldOptions& options);
  Result<void> compile(const WorldModel& world, const RobotModel& robot, MujocoSettings settings);
  Eigen::Isometry3d moving_pose(int body) const override;
  void kick(int body, const Eigen::Vector3d& velocity, const Eigen::Vector3d& spin) override;
  void push_links();
  void read_joints();

  MotorParams motor_;
  ModelPtr mujoco_;
  std::unique_ptr<mjData, DeleteData> data_;
  std::vector<int> body_ids_;                // MuJoCo's number of each body
  std::vector<int> angle_at_, velocity_at_;  // index in qpos and in qvel of each joint
  ImuByDifferences imu_by_differences_;
};

}  // namespace kaz::sim::bench
