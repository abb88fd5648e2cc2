// For tests: a whole virtual robot in lockstep, with host, wire, native firmware, noisy board and bodies.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/robot/robot.h"
#include "shared/base/angle.hpp"
#include "tools/lockstep/lockstep.h"

namespace kaz {

// Returns whether KAZ_LONG=1 selects the long versions of tests. Also, KAZ_DYNAMICS selects other dynamics
// (sim/body/world/world.h), and KAZ_PHYSICS_STEP another step length, ms.
inline bool long_run() {
  const char* value = std::getenv("KAZ_LONG");
  return value != nullptr && std::string(value) == "1";
}

// Returns SDF of a world with a floor as in sim/worlds, and `models`.
inline std::string world_of(const std::string& models) {
  return R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:kaz="urn:kaz:sdf"><world name="test">
<model name="floor"><static>true</static><link name="l"><collision name="c">
<geometry><plane><normal>0 0 1</normal><size>8 8</size></plane></geometry>
<surface><friction><ode><mu>0.7</mu></ode></friction></surface></collision></link></model>
)" + models +
         "</world></sdf>\n";
}

// Returns SDF of a ball. `at`: "x y z", m. `kicks`: <kaz:kick> elements that throw it.
inline std::string ball(const std::string& at, double mass_kg, double radius_m,
                        const std::string& kicks) {
  const auto text = [](double x) { return std::to_string(x); };
  std::string inertia = std::to_string(0.4 * mass_kg * radius_m * radius_m * 1e6);
  inertia += "e-6";
  return R"(<model name="ball"><pose>)" + at +
         R"( 0 0 0</pose><link name="ball"><inertial><mass>)" + text(mass_kg) +
         "</mass><inertia><ixx>" + inertia + "</ixx><iyy>" + inertia + "</iyy><izz>" + inertia +
         R"(</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial><collision name="c">
<geometry><sphere><radius>)" +
         text(radius_m) + R"(</radius></sphere></geometry><surface><friction><ode><mu>1.0</mu></ode>
</friction></surface></collision></link>)" +
         kicks + "</model>";
}

class RobotFixture {
 public:
  // Connects to a new robot, sets the behaviors' gains and switches all joints on. Returns null after an
  // error, which is reported as a test failure.
  static std::unique_ptr<RobotFixture> start(const std::string& world, std::uint64_t seed = 1) {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    const auto path = std::filesystem::path(testing::TempDir()) /
                      ("kaz_" + std::string(info->name()) + std::to_string(getpid()) + ".sdf");
    std::ofstream(path) << world;
    sim::SimulationOptions options;
    options.mcu = sim::McuKind::native;
    if (const char* dynamics = std::getenv("KAZ_DYNAMICS")) options.dynamics = dynamics;
    if (const char* step = std::getenv("KAZ_PHYSICS_STEP"))
      options.physics_step_ms = std::atof(step);
    options.seed = seed;
    options.world_path = path;
    options.robot_path = "shared/robot/kaz/kaz.urdf";
    options.camera_path = "shared/robot/kaz/camera.json";
    auto simulation = sim::Simulation::create(options);
    std::filesystem::remove(path);
    if (!simulation) {
      ADD_FAILURE() << simulation.error().message;
      return nullptr;
    }
    std::unique_ptr<RobotFixture> fixture(new RobotFixture(std::move(*simulation)));
    auto robot = host::Robot::connect(fixture->link_, fixture->clock_);
    if (!robot) {
      ADD_FAILURE() << robot.error().message;
      return nullptr;
    }
    fixture->robot_ = std::make_unique<host::Robot>(std::move(*robot));
    // The expected drifts and forces were measured with the gains of the behaviors.
    constexpr auto kHands = 1u << host::l_hand | 1u << host::r_hand;
    auto on = fixture->robot_->set_gains(host::kAllJoints & ~kHands,
                                         {.kp_per_rad = 20, .kd_s_per_rad = 0.15});
    if (on) on = fixture->robot_->set_gains(kHands, {.kp_per_rad = 0.8, .kd_s_per_rad = 0.15});
    if (on) on = fixture->robot_->enable(host::kAllJoints);
    if (!on) {
      ADD_FAILURE() << on.error().message;
      return nullptr;
    }
    return fixture;
  }

  host::Robot& robot() { return *robot_; }
  const sim::World& world() const { return simulation_->world(); }
  double time_s() const { return seconds(simulation_->time()); }

  // Waits. Meanwhile the robot's clock keeps the board's link watchdog from reacting.
  void wait(double for_s) {
    const auto slept = robot_->clock().sleep_until(clock_.now() + from_seconds(for_s));
    ASSERT_TRUE(slept) << slept.error().message;
  }
  // Moves joints and waits until the motion has ended.
  void move(const std::vector<host::JointTarget>& targets, double duration_s) {
    const auto set = robot_->set_targets(targets, from_seconds(duration_s));
    ASSERT_TRUE(set) << set.error().message;
    wait(duration_s);
  }
  // Moves into the crouch from which walking starts (docs/reference/robot.md).
  void stand_in_crouch() {
    std::vector<host::JointTarget> targets;
    for (const auto& [joint, degrees] :
         std::initializer_list<std::pair<int, double>>{{host::l_hip_pitch, -30.8},
                                                       {host::r_hip_pitch, -30.8},
                                                       {host::l_knee, 55.6},
                                                       {host::r_knee, 55.6},
                                                       {host::l_ankle_pitch, -27.8},
                                                       {host::r_ankle_pitch, -27.8},
                                                       {host::l_sh_roll, 12},
                                                       {host::r_sh_roll, -12},
                                                       {host::l_elbow, -40},
                                                       {host::r_elbow, -40}})
      targets.push_back({joint, degrees * kDegree});
    move(targets, 2.0);
    wait(0.5);
  }

  // Ground truth.
  Eigen::Isometry3d trunk() const { return world().link_pose("trunk"); }
  double tilt_deg() const { return std::acos(std::min(1.0, trunk().linear()(2, 2))) / kDegree; }
  Eigen::Vector3d ball() const { return world().object_position("ball").value(); }

 private:
  explicit RobotFixture(std::unique_ptr<sim::Simulation> simulation)
      : simulation_(std::move(simulation)), clock_(*simulation_), link_(*simulation_) {}

  std::unique_ptr<sim::Simulation> simulation_;
  lockstep::LockstepClock clock_;
  lockstep::LockstepLink link_;
  std::unique_ptr<host::Robot> robot_;
};

}  // namespace kaz
