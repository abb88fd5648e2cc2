// Robot and other bodies in MuJoCo, only for the benchmark of the body.
// SPDX-License-Identifier: Apache-2.0
//
// Files, masses, shapes, motor line and loop are those of all steppers. The solver is Newton's method on
// MuJoCo's convex model of contacts, with elliptic cones. Differences:
// - Contacts and stops are MuJoCo's springs and dampers (mujoco_model.cpp).
// - The larger friction of a pair of surfaces counts.
// - The gear has no backlash.
// - Bodies do not fall asleep: Debian's version has no islands.
// Poses are those at the beginning of the last step, as mj_step leaves them.
#pragma once

#include <memory>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/body/world/staged_world.h"
#include "tools/benchmark/common/imu_by_differences.h"

namespace kaz::sim::bench {

class MujocoWorld final : public StagedWorld {
 public:
  // Loads the files as World::load does. Returns Fault::failed if MuJoCo rejects the model, else errors of
  // the files.
  static Result<std::unique_ptr<World>> load(const std::string& world_path,
                                             const std::string& robot_path,
                                             const WorldOptions& options);

  void step(std::span<const MotorDrive> drives, double supply_volts) override;
  int find_contacts() override;
  double largest_joint_gap_m() const override { return 0; }  // reduced coordinates
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
  Result<void> compile(const WorldModel& world, const RobotModel& robot);
  Eigen::Isometry3d moving_pose(int body) const override;
  void kick(int body, const Eigen::Vector3d& velocity) override;
  void push_links();
  void read_joints();

  MotorParams motor_;
  ModelPtr mujoco_;
  std::unique_ptr<mjData, DeleteData> data_;
  std::vector<int> body_ids_;                // MuJoCo's number by body
  std::vector<int> angle_at_, velocity_at_;  // indices in qpos and qvel by joint
  ImuByDifferences imu_by_differences_;
};

}  // namespace kaz::sim::bench
