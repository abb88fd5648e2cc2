// The robot and the other bodies in Bullet's multibody dynamics, for the benchmark of the body alone.
// SPDX-License-Identifier: Apache-2.0
//
// btMultiBody: Featherstone's articulated bodies in reduced coordinates, rows of motors and
// contacts by projected Gauss-Seidel with a number of iterations. The same files, masses, shapes,
// motor law, stops and surfaces as under every stepper. What differs: contacts are found by Bullet
// and kept from step to step; friction does not remember its shear (contact_memory.h); bodies that
// touch fall asleep together.
#pragma once

#include <memory>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "sim/body/world/staged_world.h"
#include "tools/benchmark/common/imu_by_differences.h"
#include "tools/benchmark/bullet/bullet_joint_row.h"
#include "tools/benchmark/bullet/bullet_shapes.h"

namespace kaz::sim::bench {

class BulletWorld final : public StagedWorld {
 public:
  BulletWorld(const WorldModel& world, const RobotModel& robot, const MotorParams& motor,
              const WorldOptions& options, int iterations);
  ~BulletWorld() override;

  // From the files, as World::load. The stepper is "bulletN" with N iterations.
  static Result<std::unique_ptr<World>> load(const std::string& world_path,
                                             const std::string& robot_path,
                                             const WorldOptions& options);

  void step(std::span<const MotorDrive> drives, double supply_volts) override;
  int find_contacts() override;
  double largest_joint_gap_m() const override { return 0; }  // reduced coordinates
  std::string dynamics() const override { return "bullet" + std::to_string(iterations_); }

 private:
  // Links so near in the tree that their shapes may overlap at the joints never meet.
  struct Filter final : btOverlapFilterCallback {
    bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override;
    std::size_t links = 0;
    std::vector<char> exempt;  // [a * links + b]
  };
  struct Joint {
    int link = 0;  // Bullet's number: that of RobotModel::links less one
    double lower = 0, upper = 0;
    std::unique_ptr<BulletJointRow> motor, lower_stop, upper_stop;
  };

  Eigen::Isometry3d moving_pose(int body) const override;
  void kick(int body, const Eigen::Vector3d& velocity) override;
  void add_robot(const RobotModel& robot);
  void set_up_link(const RobotModel& robot, int link);
  void add_collider(const RobotModel& robot, int link);
  void add_joints(const RobotModel& robot);
  void add_bodies(const WorldModel& world);
  void add_moving_body(const WorldBody& world_body, int body);
  void set_joint_rows();
  void read_joints();

  int iterations_;
  BulletShapes shapes_;
  Filter filter_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::unique_ptr<btMultiBody> robot_;
  std::vector<Joint> joints_;
  std::vector<PrincipalFrame> frames_;  // by number of body
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  std::vector<std::unique_ptr<btCollisionObject>> fixed_;
  // By number of body less the robot's links.
  std::vector<std::unique_ptr<btRigidBody>> moving_bodies_;
  ImuByDifferences imu_by_differences_;
};

}  // namespace kaz::sim::bench
