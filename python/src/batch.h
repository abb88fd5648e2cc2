// Simulates many robots in several threads. kaz.VectorEnv is based on this class.
// SPDX-License-Identifier: Apache-2.0
//
// A step is one control period. With the engines `native` and `h8`, each robot has its own servo board.
// Targets are sent over the emulated serial line at the beginning of a period. Measurements are the
// potentiometer readings of the newest reply. With the engine `none` there is no board. In each physics step,
// a control law drives the motor model directly. This law is like the control law of the board, but uses true
// angles and speeds.
//
// Robots share no mutable state, so results do not depend on the number of threads. A Batch is not
// thread-safe.
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
  sim::SimulationOptions simulation;  // options of each simulation; reset() sets the seed
  Engine engine = Engine::native;
  int robots = 1, threads = 1;
  bool pictures = false;  // whether the cameras are on; must be false with the engine `none`
  int period_ms = 20;     // 20 to 200; the serial line needs at least 20 ms
  // Posture after a reset, rad by joint, and the time in which the robot settles in this posture.
  std::array<double, KZ_JOINTS> posture{};
  int settle_ms = 300;
  // Gains; the defaults are the board's gains after a reset.
  double kp_per_rad = 16, kd_s_per_rad = 0.09;
};

// State of each robot after a period. `measured` and `inertial` are received over the serial line, all other
// members are ground truth. With the engine `none`, all members are ground truth.
struct BatchState {
  static constexpr std::size_t kJoints = KZ_JOINTS;
  std::vector<double> measured;  // measured joint angles, robots x 18, rad
  // Robots x 3: yaw rate, rad/s; specific force forward and to the left, m/s^2.
  std::vector<double> inertial;
  std::vector<double> trunk;      // robots x 7, world frame: position m, quaternion x y z w
  std::vector<double> ball;       // robots x 3, world frame, m; 0 if the world has no ball
  std::vector<std::uint8_t> off;  // one per robot: 1 if the motor drivers are off
  // One per robot: time since the exposure of the pair that pictures() returns, s. Empty if the cameras are
  // off.
  std::vector<double> picture_age;
};

class Batch {
 public:
  // Loads the world once. Then powers on the board of one robot, enables the motors, moves the robot to the
  // posture and waits until the robot has settled. Each episode starts from the settled state. Returns the
  // errors of Simulation::create. Other errors: robots, threads or period out of range; a robot with other
  // joints; `pictures` with an engine or robot without cameras.
  static Result<std::unique_ptr<Batch>> create(BatchOptions options);
  ~Batch();

  // Starts a new episode for each robot `i` that has a seed in `seeds`. The episode starts in the posture of
  // the options. The seed determines noise and errors of the sensors. The board reads these sensors for one
  // period before the episode starts. If sensor errors shift the posture (pot_as_built), the robot settles
  // for another `settle_ms`.
  Result<void> reset(std::span<const std::optional<std::uint64_t>> seeds);
  // Advances all robots by one period, except robots whose entry in `resting` is not 0. `resting` has one
  // entry per robot. `targets`: robots x 18, rad, clipped to the joints' limits. Errors: called before
  // reset(); a robot's chip or board has stopped.
  Result<void> step(std::span<const double> targets, std::span<const std::uint8_t> resting);
  // Applies an impulse (N s, world frame) to a link during the next period. Errors of push(), accelerate()
  // and link_pose(): called before reset(); no such robot, link or model.
  Result<void> push(int robot, const std::string& link, const Eigen::Vector3d& impulse);
  // Adds `change` (m/s, world frame) to the velocity of an object.
  Result<void> accelerate(int robot, const std::string& model, const Eigen::Vector3d& change);
  const BatchState& state() const { return state_; }
  const BatchOptions& options() const { return options_; }
  const vision::CameraModel& camera() const { return model_; }
  // Returns the newest pair of pictures that robot `i` has received by the end of the period. Valid until the
  // next step() or reset(). Null if no pair has arrived yet, or the cameras are off.
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
  // Initial state of all episodes: `settled_` with the engine `none`, else `start_`. `prototype_` is the
  // world as loaded.
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
