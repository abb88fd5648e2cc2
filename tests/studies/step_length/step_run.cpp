// One run of the whole virtual robot under a physics step of a given length.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/step_length/step_run.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "host/robot/robot.h"
#include "sim/body/description/robot_model.h"
#include "sim/body/world/gait_testing.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::step_length {
namespace {

constexpr double kIntoCrouch = 2.0, kIntoWalk = 2.0;  // s
constexpr int kControlMs = 20;
constexpr char kRobot[] = "shared/robot/kaz/kaz.urdf";

// The ball is kicked at 1 s, slides, and rolls.
constexpr char kWorld[] = R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:kaz="urn:kaz:sdf"><world name="test">
<model name="floor"><static>true</static><link name="l"><collision name="c">
<geometry><plane><normal>0 0 1</normal><size>20 20</size></plane></geometry>
<surface><friction><ode><mu>0.7</mu></ode></friction></surface></collision></link></model>
<model name="ball"><pose>0.3 0.5 0.02 0 0 0</pose><link name="ball"><inertial><mass>0.015</mass>
<inertia><ixx>2.4e-6</ixx><iyy>2.4e-6</iyy><izz>2.4e-6</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz>
</inertia></inertial><collision name="c"><geometry><sphere><radius>0.02</radius></sphere></geometry>
<surface><friction><ode><mu>1.0</mu></ode></friction></surface></collision></link>
<kaz:kick time="1.0" velocity="0.5 0.2 0"/></model>
</world></sdf>
)";

sim::bench::Angles targets_at(Load load, double time) {
  const double walk =
      load == Load::walk ? std::clamp((time - kIntoCrouch) / kIntoWalk, 0.0, 1.0) : 0.0;
  sim::bench::Angles angles =
      sim::bench::walking_angles(walk, std::fmod(std::max(0.0, time - kIntoCrouch), 1.0));
  const double share = std::min(1.0, time / kIntoCrouch);
  for (double& angle : angles) angle *= share;
  return angles;
}

Sample sample_of(const sim::World& world, const sim::bench::Angles& target) {
  Sample sample;
  sample.target = target;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) sample.angle[j] = world.joints()[j].angle;
  sample.trunk = world.link_pose("trunk");
  sample.ball = world.object_position("ball").value_or(Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < world.link_forces().size(); ++i) {
    const std::string& name = world.link_order()[i];
    const double up = (world.link_pose(name).linear() * world.link_forces()[i].force).z();
    if (name == "l_ankle_pitch") sample.left = up;
    if (name == "r_ankle_pitch") sample.right = up;
  }
  return sample;
}

std::string world_file() {
  const auto path = std::filesystem::temp_directory_path() /
                    ("kaz_step_length" + std::to_string(getpid()) + ".sdf");
  std::ofstream(path) << kWorld;
  return path;
}

Result<std::unique_ptr<sim::Simulation>> make(const Setting& setting) {
  sim::SimulationOptions options;
  options.world_path = world_file();
  options.robot_path = kRobot;
  options.camera_path = "shared/robot/kaz/camera.json";
  options.sensors = sim::SensorSet::ideal;
  options.dynamics = setting.stepper;
  options.physics_step_ms = setting.step_ms;
  auto simulation = sim::Simulation::create(options);
  std::filesystem::remove(options.world_path);
  return simulation;
}

Result<Course> with_weight() {
  Course run;
  const auto model = KAZ_TRY(sim::load_robot(kRobot));
  run.weight = 9.81 * model.mass();
  return run;
}

void add(Course& run, int ms, const Sample& sample) {
  run.max_tilt =
      std::max(run.max_tilt, std::acos(std::clamp(sample.trunk.linear()(2, 2), -1.0, 1.0)));
  run.at.emplace(ms, sample);
}

}  // namespace

Result<Course> run_smooth(const Setting& setting) {
  sim::WorldOptions options;
  options.dynamics = setting.stepper;
  options.step_s = setting.step_ms / 1000;
  options.ideal_motors = true;
  const std::string path = world_file();
  const auto loaded = sim::World::load(path, kRobot, options);
  std::filesystem::remove(path);
  if (!loaded) return tl::unexpected(loaded.error());
  const auto ratio = KAZ_TRY(sim::step_ratio(setting.step_ms));
  sim::World& world = **loaded;
  auto run = with_weight();
  if (!run) return run;
  std::array<sim::MotorDrive, KZ_JOINTS> drives{};
  const auto started = std::chrono::steady_clock::now();
  for (int ms = 0; ms < static_cast<int>(1000 * setting.seconds); ++ms) {
    const auto angles = targets_at(setting.load, 1e-3 * ms);
    const int late = ms % ratio.ticks_a_step;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      const sim::JointState& joint = world.joints()[j];
      const double angle = joint.angle + 1e-3 * late * joint.velocity;
      const double duty = std::clamp(
          setting.gain * (angles[j] - angle) - setting.damping * joint.velocity, -1.0, 1.0);
      drives[j].powered = true;
      drives[j].duty = (late == 0 ? 0 : drives[j].duty) + duty / ratio.ticks_a_step;
    }
    if (late + 1 < ratio.ticks_a_step) continue;
    for (int k = 0; k < ratio.steps_a_tick; ++k) world.step(drives, 10);
    add(*run, ms + 1, sample_of(world, targets_at(setting.load, 1e-3 * (ms + 1))));
  }
  run->physics_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return run;
}

Result<Course> run(const Setting& setting) {
  auto simulation = KAZ_TRY(make(setting));
  sim::Simulation& sim = *simulation;
  lockstep::LockstepClock clock(sim);
  lockstep::LockstepLink link(sim);
  auto robot = KAZ_TRY(host::Robot::connect(link, clock));
  host::Gains gains;
  gains.kp_per_rad = setting.gain;
  gains.kd_s_per_rad = setting.damping;
  KAZ_TRY(robot.set_gains(host::kAllJoints, gains));
  KAZ_TRY(robot.enable(host::kAllJoints));
  const Time lead = from_seconds(1e-3 * setting.lead_ms);
  // The same time in each run: a multiple of all step lengths.
  const Time begin = from_seconds(0.2) + lead;
  KAZ_TRY(robot.clock().sleep_until(begin));

  auto run = with_weight();
  if (!run) return run;
  const auto started = std::chrono::steady_clock::now();
  const int cycles = static_cast<int>(setting.seconds * 1000) / kControlMs;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    // Targets at the end of the ramp.
    const auto angles = targets_at(setting.load, 1e-3 * kControlMs * (cycle + 1));
    std::vector<host::JointTarget> targets;
    for (int j = 0; j < KZ_JOINTS; ++j) targets.push_back({j, angles[static_cast<std::size_t>(j)]});
    KAZ_TRY(robot.set_targets(targets, std::chrono::milliseconds(kControlMs)));
    for (int ms = 1; ms <= kControlMs; ++ms) {
      const int at = cycle * kControlMs + ms;
      const Time until = begin + std::chrono::milliseconds(at);
      if (until <= sim.time()) continue;
      KAZ_TRY(robot.clock().sleep_until(until));
      add(*run, at, sample_of(sim.world(), targets_at(setting.load, 1e-3 * at)));
    }
  }
  run->physics_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return run;
}

Deviation deviation(const Course& run, const Course& reference) {
  Deviation result;
  double joints = 0, tracking = 0, force = 0;
  std::size_t samples = 0, windows = 0, in_window = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int window = -1;
  const auto close = [&] {
    if (in_window > 0) {
      force += (sum / static_cast<double>(in_window)).squaredNorm() / 2;
      ++windows;
    }
    sum.setZero();
    in_window = 0;
  };
  for (const auto& [ms, now] : run.at) {
    const auto other = reference.at.find(ms);
    if (other == reference.at.end()) continue;
    const Sample& then = other->second;
    ++samples;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      joints += std::pow(now.angle[j] - then.angle[j], 2) / KZ_JOINTS;
      tracking += std::pow(now.angle[j] - now.target[j], 2) / KZ_JOINTS;
    }
    result.trunk =
        std::max(result.trunk, (now.trunk.translation() - then.trunk.translation()).norm());
    const Eigen::Matrix3d turn = then.trunk.linear().transpose() * now.trunk.linear();
    result.heading = std::max(result.heading, std::abs(std::atan2(turn(1, 0), turn(0, 0))));
    result.ball = std::max(result.ball, (now.ball - then.ball).norm());
    if (ms / kControlMs != window) close();
    window = ms / kControlMs;
    sum += Eigen::Vector2d(now.left - then.left, now.right - then.right);
    ++in_window;
  }
  close();
  if (samples == 0) return result;
  result.joints = std::sqrt(joints / static_cast<double>(samples));
  result.tracking = std::sqrt(tracking / static_cast<double>(samples));
  result.force = std::sqrt(force / static_cast<double>(windows)) / run.weight;
  return result;
}

}  // namespace kaz::step_length
