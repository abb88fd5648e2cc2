// For tests: a simulation whose world has no physics and whose renderer draws nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "sim/body/description/robot_model.h"
#include "sim/body/world/world.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::sim {

// World without physics. Each joint turns at 5 rad/s times the duty of the joint's motor. The head frame
// turns with the joint neck_pan.
class TestWorld final : public World {
 public:
  explicit TestWorld(double step_s = 0.001) : step_s_(step_s) {
    scene_.frames = {"world", "neck_tilt"};
  }

  double step_s() const override { return step_s_; }
  double time_s() const override { return time_; }
  void step(std::span<const MotorDrive> drives, double supply_volts) override {
    ++steps_;
    last_duty_ = drives[0].duty;
    time_ += step_s_;
    supply_volts_ = supply_volts;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      joints_[j].velocity = drives[j].powered ? 5.0 * drives[j].duty : 0.0;
      joints_[j].angle += step_s_ * joints_[j].velocity;
    }
  }
  std::span<const JointState> joints() const override { return joints_; }
  std::span<const std::string> joint_order() const override { return joint_names(); }
  double supply_current_a() const override { return 1.0; }
  const ImuState& imu() const override { return imu_; }
  const Scene& scene() const override { return scene_; }
  ScenePose pose() const override {
    return {{Eigen::Isometry3d::Identity(), link_pose("neck_tilt")}};
  }
  int head_frame() const override { return 1; }
  Eigen::Isometry3d link_pose(const std::string& link) const override {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.rotate(Eigen::AngleAxisd(joints_[0].angle, Eigen::Vector3d::UnitZ()));
    if (link == "left_eye") pose.translate(Eigen::Vector3d(0.03, 0.02, 0));
    if (link == "right_eye") pose.translate(Eigen::Vector3d(0.03, -0.02, 0));
    return pose;
  }
  Result<Eigen::Vector3d> object_position(const std::string& model) const override {
    if (model == "ball") return Eigen::Vector3d(1.0, time_, 0.02);
    return fail(Fault::usage, "there is no " + model);
  }
  double largest_joint_gap_m() const override { return 0; }
  std::string dynamics() const override { return "none"; }

  double supply_volts() const { return supply_volts_; }
  int steps() const { return steps_; }
  double last_duty() const { return last_duty_; }

 private:
  Scene scene_;
  ImuState imu_{Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 9.81)};
  double step_s_;
  int steps_ = 0;
  double time_ = 0, supply_volts_ = 0, last_duty_ = 0;
  std::array<JointState, KZ_JOINTS> joints_{};
};

// Renderer that draws nothing. The first two bytes of a picture are the camera's position: x and y in mm,
// modulo 256.
class TestRenderer final : public Renderer {
 public:
  Result<void> set_scene(const Scene&) override { return {}; }
  Result<void> render(const ScenePose&, const View& view, vision::Image& picture) override {
    picture.width = view.camera.width;
    picture.height = view.camera.height;
    picture.rgb.assign(static_cast<std::size_t>(picture.width) * picture.height * 3, 7);
    const Eigen::Vector3d at = view.world_from_optical.translation();
    picture.rgb[0] = static_cast<std::uint8_t>(std::lround(at.x() * 1000));
    picture.rgb[1] = static_cast<std::uint8_t>(std::lround(at.y() * 1000));
    return {};
  }
};

inline Result<std::unique_ptr<Renderer>> make_test_renderer() {
  return std::unique_ptr<Renderer>(std::make_unique<TestRenderer>());
}

inline CameraFile small_camera() {
  CameraFile camera;
  camera.eye.width = 32;
  camera.eye.height = 24;
  return camera;
}

inline std::unique_ptr<Simulation> test_simulation(SimulationOptions options = {},
                                                   double step_s = 0.001) {
  options.make_renderer = make_test_renderer;
  options.sensor_params = load_sensor_file("shared/robot/kaz/sensors.xml").value();
  auto simulation = Simulation::assemble(options, make_native(),
                                         std::make_unique<TestWorld>(step_s), small_camera());
  if (!simulation) return nullptr;
  return std::move(*simulation);
}

// Temporary folder that the destructor removes.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "kaz-test-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TestFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

}  // namespace kaz::sim
