// Motors without a body, and a watched world.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/plant.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include "shared/board/table.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/motor/joint_motor.h"

namespace kaz::fuzz {
namespace {

using sim::JointState;
using sim::MotorDrive;

constexpr double kStep = 0.001;
constexpr double kStopMargin = 0.0175;  // rad beyond the joint's limits, as in sim/body

class MotorBench final : public sim::World {
 public:
  MotorBench() : motors_(KZ_JOINTS, sim::JointMotor(bench_motor(), kStep)) {
    scene_.frames = {"world", "neck_tilt"};
  }
  double step_s() const override { return kStep; }
  double time_s() const override { return time_; }
  // Each shaft: I (w1 - w0)/h = torque, w1 + softness * torque = velocity.
  void step(std::span<const MotorDrive> drives, double supply_volts) override {
    time_ += kStep;
    current_ = 0;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      JointState& joint = joints_[j];
      const auto row = motors_[j].prepare(drives[j], supply_volts, joint.angle, joint.velocity);
      // From a light hand to a leg that carries the trunk.
      const double inertia = 1e-4 * (1.0 + static_cast<double>(j * j));
      joint.torque = std::clamp((row.velocity - joint.velocity) / (row.softness + kStep / inertia),
                                row.min, row.max);
      joint.velocity += kStep / inertia * joint.torque;
      joint.angle += kStep * joint.velocity;
      motors_[j].finish(joint.velocity, joint.torque);
      current_ += motors_[j].supply_current();
      const kz_board_joint& wiring = kz_board_joints[j];
      const double lower = 1e-4 * wiring.lower - kStopMargin;
      const double upper = 1e-4 * wiring.upper + kStopMargin;
      if (joint.angle < lower || joint.angle > upper) {
        joint.angle = std::clamp(joint.angle, lower, upper);
        joint.velocity = 0;
      }
    }
  }
  std::span<const JointState> joints() const override { return joints_; }
  std::span<const std::string> joint_order() const override { return sim::joint_names(); }
  double supply_current_a() const override { return current_; }
  const sim::ImuState& imu() const override { return at_rest_; }
  const sim::Scene& scene() const override { return scene_; }
  sim::ScenePose pose() const override {
    return {{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()}};
  }
  int head_frame() const override { return 1; }
  Eigen::Isometry3d link_pose(const std::string&) const override {
    return Eigen::Isometry3d::Identity();
  }
  Result<Eigen::Vector3d> object_position(const std::string& model) const override {
    return fail(Fault::usage, "the motor bench has no object `" + model + "`");
  }
  double largest_joint_gap_m() const override { return 0; }
  std::string dynamics() const override { return "none"; }

 private:
  std::vector<sim::JointMotor> motors_;
  std::array<JointState, KZ_JOINTS> joints_{};
  double time_ = 0, current_ = 0;
  sim::Scene scene_;
  sim::ImuState at_rest_{Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 9.81)};
};

class WatchedWorld final : public sim::World {
 public:
  WatchedWorld(std::unique_ptr<sim::World> world, DriveWatch watch)
      : world_(std::move(world)), watch_(std::move(watch)) {}
  double step_s() const override { return world_->step_s(); }
  double time_s() const override { return world_->time_s(); }
  void step(std::span<const MotorDrive> drives, double supply_volts) override {
    world_->step(drives, supply_volts);
    watch_(drives, world_->joints());
  }
  std::span<const JointState> joints() const override { return world_->joints(); }
  std::span<const std::string> joint_order() const override { return world_->joint_order(); }
  double supply_current_a() const override { return world_->supply_current_a(); }
  const sim::ImuState& imu() const override { return world_->imu(); }
  const sim::Scene& scene() const override { return world_->scene(); }
  sim::ScenePose pose() const override { return world_->pose(); }
  int head_frame() const override { return world_->head_frame(); }
  Eigen::Isometry3d link_pose(const std::string& link) const override {
    return world_->link_pose(link);
  }
  Result<Eigen::Vector3d> object_position(const std::string& model) const override {
    return world_->object_position(model);
  }
  double largest_joint_gap_m() const override { return world_->largest_joint_gap_m(); }
  std::string dynamics() const override { return world_->dynamics(); }

 private:
  std::unique_ptr<sim::World> world_;
  DriveWatch watch_;
};

}  // namespace

sim::MotorParams bench_motor() {
  return {.name = "s9204-jskd04",
          .stall_slope_nm_per_v = 0.2288,
          .friction_nm = 0.128,
          .back_emf_nms_per_rad = 0.1764,
          .stiction_ratio = 1.3,
          .rotor_inertia_kgm2 = 5e-4,
          .max_supply_v = 12,
          .backlash_rad = 0.4 * (std::numbers::pi / 180),
          .winding_heat_capacity = 5,
          .winding_to_case = 24,
          .case_heat_capacity = 30,
          .case_to_air = 14,
          .copper_per_kelvin = 0.00393,
          .air_celsius = 25};
}

std::unique_ptr<sim::World> make_motor_bench() {
  return std::make_unique<MotorBench>();
}

std::unique_ptr<sim::World> watched(std::unique_ptr<sim::World> world, DriveWatch watch) {
  return std::make_unique<WatchedWorld>(std::move(world), std::move(watch));
}

}  // namespace kaz::fuzz
