// Many simulated robots, stepped in threads: what kaz.VectorEnv stands on.
// SPDX-License-Identifier: Apache-2.0
//
// A robot is stepped by control periods. On the engines `native` and `h8` each has a servo board of its own:
// its targets leave over the emulated serial line at the beginning of a period, and what the robot measures
// are the newest reply's potentiometers. On `none` there is no board: a law of the board's kind, with true
// angles and speeds, drives the motor model directly, each millisecond.
//
// Robots share nothing that changes: results are the same for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "python/src/renderers.h"
#include "shared/base/result.hpp"
#include "shared/board/board.h"
#include "shared/protocol/frame.h"
#include "sim/body/world/world.h"
#include "sim/runtime/simulation/simulation.h"

namespace kaz::python {

enum class Engine { none, native, h8 };
inline constexpr std::array kEngines{Engine::none, Engine::native, Engine::h8};
constexpr const char* to_string(Engine engine) {
  return engine == Engine::none ? "none" : engine == Engine::native ? "native" : "h8";
}

struct BatchOptions {
  sim::SimulationOptions simulation;  // files and kinds; its seed is reset()'s
  Engine engine = Engine::native;
  int robots = 1, threads = 1;
  bool pictures = false;  // the eyes are open; not on the engine `none`
  int period_ms = 20;     // 20..200: what the wire has time for
  // Where the robot stands once it is reset, rad, by joint, and for how long it settles there.
  std::array<double, KZ_JOINTS> posture{};
  int settle_ms = 300;
  double kp_per_rad = 16, kd_s_per_rad = 0.09;  // as the board has after a reset
};

// What is known of each robot after a period. `measured`: over the wire. The rest is the simulation's truth.
struct BatchState {
  static constexpr std::size_t kJoints = KZ_JOINTS;
  std::vector<double> measured;  // robots x 18, rad
  std::vector<double>
      inertial;               // robots x 3: yaw rate rad/s, specific force forward and left m/s^2
  std::vector<double> trunk;  // robots x 7, world frame: position m, quaternion x y z w
  std::vector<double> ball;   // robots x 3, world frame, m; 0 where the world has none
  std::vector<std::uint8_t> off;  // the board has switched its motors off
  std::vector<double>
      picture_age;  // s since the exposure of pictures(), one a robot; empty without them
};

class Batch {
 public:
  // Loads the world once, and powers one board on, which enables its motors, moves to the posture and
  // settles: each episode begins from that state. Errors: those of Simulation::create; robots or threads out
  // of range.
  static Result<std::unique_ptr<Batch>> create(BatchOptions options);
  ~Batch();

  // Robot `i` anew, for those with a seed: standing in the posture. The seed is that of the sensors' noise
  // and errors, which the board has felt for a period then; where they move the posture (pot_as_built),
  // for `settle_ms` more.
  Result<void> reset(std::span<const std::optional<std::uint64_t>> seeds);
  // One period of all robots but those whose entry of `resting` (one each) is not 0. `targets`: robots x 18,
  // rad; clipped to the joints' limits. Errors: before reset(); a robot's chip or board has stopped.
  Result<void> step(std::span<const double> targets, std::span<const std::uint8_t> resting);
  // In the next period, N s, world frame. Errors, here and below: no such robot, link or model.
  Result<void> push(int robot, const std::string& link, const Eigen::Vector3d& impulse);
  // Changes an object's velocity, m/s, world frame.
  Result<void> accelerate(int robot, const std::string& model, const Eigen::Vector3d& change);
  const BatchState& state() const { return state_; }
  const BatchOptions& options() const { return options_; }
  const vision::CameraModel& camera() const { return model_; }
  // The newest pair that has reached robot `i` by the end of its period. Null: none yet, or no pictures.
  const vision::StereoImages* pictures(std::size_t i) const;
  Result<Eigen::Isometry3d> link_pose(int robot, const std::string& link) const;

 private:
  struct Robot;
  class Workers;
  explicit Batch(BatchOptions options);
  Result<void> prepare();
  Result<std::unique_ptr<sim::Simulation>> assemble(const sim::SimulationOptions& options) const;
  Result<void> reset_one(std::size_t i, std::uint64_t seed);
  Result<void> period(Robot& robot, std::span<const double> targets, int ms);
  Result<void> run_simulated(Robot& robot, std::span<const double> targets, int ms);
  void run_bare(Robot& robot, std::span<const double> targets, int ms);
  void observe(std::size_t i);
  Result<Robot*> robot_at(int robot) const;

  BatchOptions options_;
  // Where all begin: on `none` the world alone, else `start_`. `prototype_` is as loaded.
  std::unique_ptr<sim::World> prototype_;
  std::unique_ptr<Robot> settled_;
  sim::Simulation::Start start_;
  bool has_ball_ = false;
  sim::CameraFile camera_;
  vision::CameraModel model_;
  std::unique_ptr<Renderers> renderers_;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::unique_ptr<Workers> workers_;
  BatchState state_;
};

}  // namespace kaz::python
