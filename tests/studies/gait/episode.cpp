// One run of the robot through host, wire and firmware.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/gait/episode.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/motion/reach.h"
#include "host/robot/robot.h"
#include "tools/lockstep/lockstep.h"

namespace kaz::gait {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using studies::Noise;
using studies::noise;

constexpr Time kControlCycle = std::chrono::milliseconds(20);
constexpr double kControlCycle_s = 0.020;
constexpr double kHeadingNoise = 0.02;             // rad
constexpr double kStride = 0.040, kReach = 0.012;  // m
constexpr double kStopEarly = 0.03;                // m, still walked while the amplitude ramps down
constexpr double kTurnPerSupport = 11.5 * kDegree;  // of one double support at kReach
constexpr double kTurnedEnough = 3 * kDegree;
constexpr double kStand_s = 12, kSettle_s = 0.5;
const Vector2d kBallAt(0.100, -0.055);
constexpr double kBallRadius = 0.020;

class Episode {
 public:
  Episode(const Task& task, const Setting& setting, std::uint64_t seed)
      : task_(task), setting_(setting), seed_(seed) {}

  Result<Outcome> run() {
    auto done = start();
    if (done) {
      switch (task_.kind) {
        case Kind::walk:
          done = walk();
          break;
        case Kind::turn:
          done = turn();
          break;
        case Kind::spin:
          done = spin();
          break;
        case Kind::stand:
          done = stand();
          break;
        case Kind::grab:
          done = grab();
          break;
      }
    }
    if (!done) return tl::unexpected(done.error());
    const Eigen::Isometry3d trunk = world().link_pose("trunk");
    out_.forward_m = trunk.translation().x();
    out_.heading_deg = heading_ / kDegree;
    for (const sim::JointState& joint : world().joints())
      out_.hottest_celsius = std::max(out_.hottest_celsius, joint.winding_celsius);
    return out_;
  }

 private:
  sim::World& world() { return simulation_->world(); }

  Result<void> start() {
    studies::Surroundings around;
    around.mu = task_.mu;
    around.motors = setting_.motors;
    if (task_.kind == Kind::grab) {
      around.ball = kBallAt + task_.off[seed_ % task_.off.size()] +
                    0.003 * Vector2d(noise(seed_, Noise::ball, 0), noise(seed_, Noise::ball, 1));
    }
    const auto files = KAZ_TRY(studies::disturbed_files(setting_.robot_folder, around, seed_));
    sim::SimulationOptions options;
    options.mcu = setting_.mcu;
    options.image_path = setting_.image_path;
    options.dynamics = setting_.stepper;
    options.seed = seed_;
    options.world_path = files.world();
    options.robot_path = files.robot();
    options.camera_path = files.camera();
    auto made = KAZ_TRY(sim::Simulation::create(options));
    simulation_ = std::move(made);
    clock_.emplace(*simulation_);
    link_.emplace(*simulation_);
    auto robot = KAZ_TRY(host::Robot::connect(*link_, *clock_));
    robot_.emplace(std::move(robot));
    if (auto set = set_gains(); !set) return set;
    if (auto on = robot_->enable(host::kAllJoints); !on) return on;
    // Into the crouch, each joint off by 0.5 degrees (sigma).
    JointAngles first = home();
    for (std::size_t j = 0; j < first.size(); ++j) {
      const auto& limit = host::joint_table()[j];
      first[j] = std::clamp(first[j] + 0.5 * kDegree * noise(seed_, Noise::start, j),
                            limit.lower_rad, limit.upper_rad);
    }
    if (auto moved = send(first, 2.0); !moved) return moved;
    next_cycle_ = clock_->now() + from_seconds(2.5);
    return robot_->clock().sleep_until(next_cycle_);
  }

  // Gains vary by 5 % (sigma). The neck's is lower: with its low inertia it would hunt within the backlash.
  Result<void> set_gains() {
    for (int joint = 0; joint < KZ_JOINTS; ++joint) {
      host::Gains gains{.kd_s_per_rad = 0.15};
      const bool hand = joint == host::l_hand || joint == host::r_hand;
      const bool neck = joint == host::neck_pan || joint == host::neck_tilt;
      gains.kp_per_rad = (hand   ? 0.7
                          : neck ? 12.0
                                 : 20.0) *
                         (1 + 0.05 * noise(seed_, Noise::gain, static_cast<std::uint64_t>(joint)));
      if (auto set = robot_->set_gains(std::uint32_t{1} << joint, gains); !set) return set;
    }
    return robot_->set_limits(host::kAllJoints, {.ramp_rad_per_s = 12});
  }

  Result<void> send(const JointAngles& angles, double duration_s) {
    std::array<host::JointTarget, KZ_JOINTS> targets;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      const auto joint = static_cast<std::size_t>(j);
      targets[joint] = {j, angles[joint]};
    }
    return robot_->set_targets(targets, from_seconds(duration_s));
  }

  // One control cycle: push if due, send the targets, wait, measure.
  Result<void> step(const JointAngles& angles) {
    if (task_.push_ns > 0 && pushes_ * task_.push_every_s + task_.push_every_s <= time_) {
      const double direction = 2 * std::numbers::pi * 1000 * noise(seed_, Noise::push, pushes_++);
      const Vector3d push = task_.push_ns * Vector3d(std::cos(direction), std::sin(direction), 0);
      if (auto pushed = world().push("trunk", push); !pushed) return pushed;
    }
    if (auto sent = send(angles, kControlCycle_s); !sent) return sent;
    next_cycle_ += kControlCycle;
    if (auto slept = robot_->clock().sleep_until(next_cycle_); !slept) return slept;
    time_ += kControlCycle_s;
    measure();
    return {};
  }

  // Updates the outcome from the trunk's true pose.
  void measure() {
    const Eigen::Isometry3d trunk = world().link_pose("trunk");
    const Eigen::Matrix3d axes = trunk.linear();
    // Unwrapped: full turns are counted.
    const double yaw = std::atan2(axes(1, 0), axes(0, 0));
    heading_ += std::remainder(yaw - heading_, 2 * std::numbers::pi);
    const Vector3d at = trunk.translation();
    out_.aside_m = std::max(out_.aside_m, std::abs(at.y()));
    const double tilt = std::acos(std::clamp(axes(2, 2), -1.0, 1.0)) / kDegree;
    out_.tilt_deg = std::max(out_.tilt_deg, tilt);
    // Limits of a fall. When picking up, the trunk pitches by 50 degrees with the hips at 110 mm; walking,
    // the hips are at 145 mm and the trunk rolls.
    const bool bends = task_.kind == Kind::grab;
    out_.fell = out_.fell || at.z() < (bends ? 0.08 : 0.11) || tilt > (bends ? 75 : 45);
    if (measurements_++ % 10 == 0) out_.path.push_back({1e3 * at.x(), 1e3 * at.y()});
  }

  double measured_heading() {
    return heading_ + kHeadingNoise * noise(seed_, Noise::heading, headings_++);
  }

  // Runs a cyclic motion: targets(phase, amplitude) with the amplitude ramped up in `up` cycles, until
  // ended(phase) returns true or `max_s` have passed; then the amplitude ramps down in `down` cycles.
  template <class Targets, class Ended>
  Result<void> cycle(double up, double down, double max_s, Targets targets, Ended ended) {
    const double period = task_.shape.period;
    double amplitude = 0;
    bool ending = false;
    for (double phase = 0; !out_.fell; phase += kControlCycle_s / period) {
      ending = ending || ended(phase) || time_ > max_s;
      amplitude = std::clamp(amplitude + (ending ? -1 / down : 1 / up) * kControlCycle_s / period,
                             0.0, 1.0);
      if (auto done = step(targets(phase, amplitude)); !done) return done;
      if (ending && amplitude == 0) break;
    }
    out_.seconds = time_;
    return stay(home(), kSettle_s);
  }

  Result<void> stay(const JointAngles& angles, double for_s) {
    for (double t = 0; t < for_s - 1e-9 && !out_.fell; t += kControlCycle_s)
      if (auto done = step(angles); !done) return done;
    return {};
  }

  Result<void> walk() {
    Stride stride{kStride, kStride};
    double cycle_of = -1;
    const auto targets = [&](double phase, double amplitude) {
      if (std::floor(phase) != cycle_of) {
        cycle_of = std::floor(phase);
        const double d =
            task_.hold_heading ? std::clamp(-0.06 * measured_heading(), -0.015, 0.015) : 0.0;
        stride = {kStride - d, kStride + d};
      }
      return walking(task_.shape, phase, amplitude, stride);
    };
    const double start = world().link_pose("trunk").translation().x();
    return cycle(1.5, 1.0, 25 + task_.distance / 0.02, targets, [&](double) {
      return world().link_pose("trunk").translation().x() - start > task_.distance - kStopEarly;
    });
  }

  Result<void> turn() {
    double reach = 0, half = -1;
    bool there = false;
    const auto targets = [&](double phase, double amplitude) {
      const double now = std::floor(2 * (phase - task_.shape.lag));
      if (now != half && !there) {
        half = now;
        const double left = task_.turn - measured_heading();
        there = std::abs(left) < kTurnedEnough;
        reach = kReach * std::clamp(left / kTurnPerSupport, -1.0, 1.0);
      }
      return turning(task_.shape, phase, amplitude, reach);
    };
    return cycle(0.7, 0.5, 40, targets, [&](double) { return there; });
  }

  Result<void> spin() {
    constexpr double kUp = 0.7;
    double before = 0, mark = std::ceil(kUp);
    const auto targets = [&](double phase, double amplitude) {
      return turning(task_.shape, phase, amplitude, kReach);
    };
    return cycle(kUp, 0.5, 60, targets, [&](double phase) {
      if (phase - task_.shape.lag < mark - 1e-9) return false;
      if (mark > std::ceil(kUp)) out_.per_cycle_deg.push_back((heading_ - before) / kDegree);
      before = heading_;
      ++mark;
      return out_.per_cycle_deg.size() == static_cast<std::size_t>(task_.cycles);
    });
  }

  Result<void> stand() {
    auto done = stay(home(), kStand_s);
    out_.seconds = time_;
    return done;
  }

  Result<void> grab() {
    const auto plan = motion::Pickup::plan(host::Side::right, kBallAt, kBallRadius);
    if (!plan) return fail(Fault::failed, "the arm does not reach the ball where it is assumed");
    // From the crouch to the plan's first posture, which shifts the centre of mass.
    if (auto sent = send(plan->at(0), 0.5); !sent) return sent;
    next_cycle_ += from_seconds(0.5);
    if (auto slept = robot_->clock().sleep_until(next_cycle_); !slept) return slept;
    while (time_ < plan->end_s() - 1e-9 && !out_.fell)
      if (auto done = step(plan->at(time_ + kControlCycle_s)); !done) return done;
    out_.seconds = time_;
    if (auto done = stay(plan->at(plan->end_s()), 1.0); !done) return done;
    const auto ball = KAZ_TRY(world().object_position("ball"));
    out_.grasp_mm = 1e3 * (ball - world().link_pose("r_elbow") * motion::kGrasp).norm();
    out_.caught = !out_.fell && out_.grasp_mm < 30 && ball.z() > 0.05;
    return {};
  }

  const Task& task_;
  const Setting& setting_;
  const std::uint64_t seed_;
  std::unique_ptr<sim::Simulation> simulation_;
  std::optional<lockstep::LockstepClock> clock_;
  std::optional<lockstep::LockstepLink> link_;
  std::optional<host::Robot> robot_;
  Outcome out_;
  Time next_cycle_{};
  double time_ = 0;     // s, since the motion began
  double heading_ = 0;  // rad
  std::uint64_t headings_ = 0, pushes_ = 0, measurements_ = 0;
};

}  // namespace

Result<Outcome> run_episode(const Task& task, const Setting& setting, std::uint64_t seed) {
  return Episode(task, setting, seed).run();
}

}  // namespace kaz::gait
