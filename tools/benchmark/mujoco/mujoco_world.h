// The robot and the other bodies in MuJoCo, for the benchmark of the body alone.
// SPDX-License-Identifier: Apache-2.0
//
// The same files, masses, shapes, motor line and loop as under every stepper; Newton on MuJoCo's convex model
// of contacts, with elliptic cones. What differs: contacts and stops are MuJoCo's springs and dampers
// (mujoco_model.cpp), the larger friction of a pair counts, the gear has no play, and nothing falls asleep
// (Debian's version has no islands). Poses are those at the beginning of the last step, as mj_step leaves
// them.
#pragma once

#include <memory>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/body/world/staged_world.h"
#include "tools/benchmark/common/imu_by_differences.h"

namespace kaz::sim::bench {

class MujocoWorld final : public StagedWorld {
 public:
  // From the files, as World::load. Errors: those of the files, and MuJoCo's own of its model.
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
  std::vector<int> body_ids_;                // MuJoCo's, by number of body
  std::vector<int> angle_at_, velocity_at_;  // by joint, in qpos and qvel
  ImuByDifferences imu_by_differences_;
};

}  // namespace kaz::sim::bench
