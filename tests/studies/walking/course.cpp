// Runs a walking behavior on a virtual robot and measures the outcome.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/walking/course.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "host/behavior/behavior.h"
#include "host/motion/gait.h"
#include "host/robot/robot.h"
#include "shared/base/angle.hpp"
#include "shared/base/random.hpp"
#include "tests/studies/common/calibrated.h"
#include "tests/studies/common/disturbed_robot.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::walking {
namespace {

using Eigen::Vector3d;

constexpr double kFallen_m = 0.11,
                 kFallen_deg = 50;  // hips' height, and trunk against the vertical
constexpr double kPathEvery_s = 0.2;
constexpr double kKnock_ns = 0.5;
constexpr Time kPoll = std::chrono::milliseconds(20);
// Standing again: above this hip height (0.145 m in the crouch) and below this tilt.
constexpr double kUp_m = 0.135, kUp_deg = 10;

// Measures the outcome from the ground truth, each millisecond, and pushes the robot.
class Observer final : public behavior::Sink {
 public:
  Observer(sim::Simulation& simulation, const Trial& trial, std::uint64_t seed, bool trace)
      : simulation_(simulation), trial_(trial), seed_(seed), trace_(trace) {}

  // Measurement starts with the phase of motion.
  void phase(Time time, std::string_view, std::string_view phase) override {
    if (phase != "walk" && phase != "turn" && phase != "hold") return;
    begin_ = seconds(time);
    origin_ = trunk();
    heading_ = 0;
    out_.path.clear();
  }

  Result<void> measure() {
    const Eigen::Isometry3d pose = trunk();
    const Eigen::Matrix3d axes = pose.linear();
    const double tilt = std::acos(std::clamp(axes(2, 2), -1.0, 1.0)) / kDegree;
    if (begin_ <= 0) return {};
    const double now = seconds(simulation_.time()) - begin_;
    const double yaw = yaw_of(pose) - yaw_of(origin_);
    heading_ += std::remainder(yaw - heading_, 2 * std::numbers::pi);
    out_.tilt_deg = std::max(out_.tilt_deg, tilt);
    if (!out_.fell && (pose.translation().z() < kFallen_m || tilt > kFallen_deg)) {
      out_.fell = true;
      out_.seconds = now;
    }
    if (!out_.fell) out_.seconds = now;
    if (now >= kPathEvery_s * static_cast<double>(out_.path.size())) {
      const Vector3d at = relative_to_start();
      out_.path.push_back({1e3 * at.x(), 1e3 * at.y()});
      if (trace_ && out_.path.size() % 2 == 0) {
        std::fprintf(stderr, "%6.2f s  x %.3f  y %.3f  heading %6.2f  tilt %5.1f  z %.3f\n", now,
                     at.x(), at.y(), heading_ / kDegree, tilt, pose.translation().z());
      }
    }
    const auto uniform = [&](std::uint64_t stream) {
      return Random(mix64(mix64(seed_ ^ stream) + pushes_)).uniform();
    };
    if (trial_.push_ns > 0 && now >= trial_.push_every_s * static_cast<double>(pushes_ + 1) +
                                         trial_.push_jitter_s * (2 * uniform(301) - 1)) {
      const double direction =
          trial_.push_sides ? (uniform(302) < 0.5 ? 90 : -90) * kDegree
          : trial_.push_to_deg
              ? *trial_.push_to_deg * kDegree
              : 2 * std::numbers::pi * 1000 * studies::noise(seed_, studies::Noise::push, pushes_);
      ++pushes_;
      const double to = direction + yaw_of(pose);
      return simulation_.world().push("trunk",
                                      trial_.push_ns * Vector3d(std::cos(to), std::sin(to), 0));
    }
    return {};
  }

  Outcome outcome() {
    const Vector3d at = relative_to_start();
    out_.forward_m = at.x();
    out_.aside_m = at.y();
    out_.heading_deg = heading_ / kDegree;
    for (const sim::JointState& joint : simulation_.world().joints())
      out_.hottest_celsius = std::max(out_.hottest_celsius, joint.winding_celsius);
    if (trial_.judged == Judged::get_up) {
      const double tilt = std::acos(std::clamp(trunk().linear()(2, 2), -1.0, 1.0)) / kDegree;
      out_.fell = trunk().translation().z() < kUp_m || tilt > kUp_deg;
      out_.seconds = seconds(simulation_.time()) - begun_;
    }
    return out_;
  }

  void begin() { begun_ = seconds(simulation_.time()); }
  bool fell() const { return out_.fell; }
  bool stops_after_fall() const {
    return (out_.fell || (trial_.most_s > 0 && begin_ > 0 && out_.seconds > trial_.most_s)) &&
           !trial_.to_the_end;
  }

 private:
  Eigen::Isometry3d trunk() const { return simulation_.world().link_pose("trunk"); }
  static double yaw_of(const Eigen::Isometry3d& pose) {
    return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
  }
  Vector3d relative_to_start() const {
    return Eigen::AngleAxisd(-yaw_of(origin_), Vector3d::UnitZ()) *
           (trunk().translation() - origin_.translation());
  }

  sim::Simulation& simulation_;
  const Trial& trial_;
  const std::uint64_t seed_;
  const bool trace_;
  Eigen::Isometry3d origin_ = Eigen::Isometry3d::Identity();
  Outcome out_;
  double begun_ = 0, begin_ = 0, heading_ = 0;
  std::uint64_t pushes_ = 0;
};

// A lockstep clock that lets the observer measure at each wait and ends the behavior after a fall.
class ObservedClock final : public host::Clock {
 public:
  ObservedClock(sim::Simulation& simulation, Observer& observer)
      : clock_(simulation), observer_(observer) {}
  Time now() const override { return clock_.now(); }
  Result<void> sleep_until(Time t) override {
    if (auto slept = clock_.sleep_until(t); !slept) return slept;
    if (auto measured = observer_.measure(); !measured) return measured;
    if (observer_.stops_after_fall()) return fail(Fault::failed, "the robot has fallen");
    return {};
  }

 private:
  lockstep::LockstepClock clock_;
  Observer& observer_;
};

// Moves into the crouch, switches the motors off, pushes the robot over and waits 2.5 s until it rests.
Result<void> knock_down(host::Robot& robot, sim::Simulation& simulation, double to_deg,
                        std::uint64_t seed) {
  const auto wait = [&robot](double time_s) -> Result<void> {
    const Time end = robot.clock().now() + from_seconds(time_s);
    while (robot.clock().now() < end) {
      if (auto slept = robot.clock().sleep_until(robot.clock().now() + kPoll); !slept) return slept;
      KAZ_TRY(robot.state());
    }
    return {};
  };
  if (auto on = robot.enable(host::kAllJoints); !on) return on;
  std::vector<host::JointTarget> crouch;
  for (int j = 0; j < KZ_JOINTS; ++j)
    crouch.push_back({j, motion::home()[static_cast<std::size_t>(j)]});
  if (auto set = robot.set_targets(crouch, from_seconds(1.5)); !set) return set;
  if (auto done = wait(2.0); !done) return done;
  if (auto off = robot.enable(0); !off) return off;
  const double to = (to_deg + 20 * studies::noise(seed, studies::Noise::push, 0)) * kDegree;
  if (auto pushed =
          simulation.world().push("trunk", kKnock_ns * Vector3d(std::cos(to), std::sin(to), 0));
      !pushed)
    return pushed;
  return wait(2.5);
}

sim::SimulationOptions options_of(const Trial& trial, const Setting& setting,
                                  const trials::RobotFolder& files, std::uint64_t seed) {
  sim::SimulationOptions options;
  options.mcu = setting.mcu;
  options.image_path = setting.image_path;
  options.seed = seed;
  options.world_path = files.world();
  options.robot_path = files.robot();
  options.camera_path = files.camera();
  options.supply_volts = trial.supply_volts;
  options.imu = trial.imu;
  options.sensors = trial.sensors;
  return options;
}

}  // namespace

Result<Outcome> run_trial(const Trial& trial, const Setting& setting, std::uint64_t seed) {
  studies::Surroundings around;
  around.mu = trial.mu;
  around.mu_spread = trial.mu_spread;
  const auto files = KAZ_TRY(studies::disturbed_files(setting.robot_folder, around, seed));
  const auto simulated = options_of(trial, setting, files, seed);
  std::optional<studies::CalibratedJoints> calibrated;
  if (trial.calibrated) calibrated = KAZ_TRY(studies::calibrate_joints(simulated));
  const auto simulation = KAZ_TRY(sim::Simulation::create(simulated));
  Observer observer(*simulation, trial, seed, setting.trace);
  ObservedClock clock(*simulation, observer);
  lockstep::LockstepLink link(*simulation);
  auto robot = KAZ_TRY(host::Robot::connect(link, clock));
  if (calibrated) KAZ_TRY(robot.set_calibration(host::kAllJoints, calibrated->all));
  const auto behavior = behavior::find_behavior(trial.behavior);
  if (!behavior) return tl::unexpected(behavior.error());
  auto options = KAZ_TRY(behavior::OptionValues::parse(behavior->options, trial.options));
  behavior::Context context{robot, clock, nullptr, observer, options, seed};
  if (trial.knocked_to_deg) {
    KAZ_TRY(knock_down(robot, *simulation, *trial.knocked_to_deg, seed));
  }
  observer.begin();
  const auto done = behavior->run(context);
  if (setting.trace && done) std::fprintf(stderr, "%s\n", done->sentence.c_str());
  if (!done && !observer.stops_after_fall()) return tl::unexpected(done.error());
  if (done && trial.judged == Judged::stand) {
    // Holds the posture under ten pushes.
    observer.phase(clock.now(), trial.name, "hold");
    const Time end = clock.now() + from_seconds(10.5 * trial.push_every_s);
    while (clock.now() < end && !observer.fell())
      if (auto slept = robot.clock().sleep_until(clock.now() + std::chrono::milliseconds(10));
          !slept && !observer.fell())
        return tl::unexpected(slept.error());
  }
  Outcome out = observer.outcome();
  if (trial.to_the_end && done) {
    out.reported["fall_detected"] = done->sentence.find("fell") != std::string::npos;
    for (const sim::JointState& joint : simulation->world().joints())
      out.reported["current_a"] += std::abs(joint.current);
  }
  if (done) {
    for (const auto& [name, value] : done->measurements) out.reported[name] = value;
  }
  return out;
}

}  // namespace kaz::walking
