// Behaviours: closed-loop programs for a robot, the same for real and virtual ones.
// SPDX-License-Identifier: Apache-2.0
//
// A behaviour is a function of Context. It blocks only in calls of the robot and the clock, which fail
// when the link fails, the camera stops or the program is interrupted; it returns that error at once.
// It leaves the motors as they are: the caller of run() calls Robot::disable_all() at the end.
//
// A new behaviour is one source file, which defines its `const Behavior`, and one line in
// behaviors.def; or a shared object (plugin.h). docs/reference/host.md shows an example.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/behavior/ball_detector.h"
#include "host/behavior/floor_detector.h"
#include "host/behavior/options.h"
#include "host/behavior/sink.h"
#include "host/robot/robot.h"

namespace kaz::behavior {

// What somebody asks of a behaviour while it runs.
class Requests {
 public:
  virtual ~Requests() = default;
  // Those that came since the last call, one line each. What is taken is recorded with `now`.
  virtual std::vector<std::string> take(Time now) = 0;
};

struct Context {
  host::Robot& robot;
  host::Clock& clock;
  BallDetector* detector;  // null without a camera; never null for behaviours with needs_camera
  Sink& sink;
  OptionValues options;
  std::uint64_t seed = 1;  // of random choices
  // Joint names of a robot other than Kaz, on the first channels of the board; empty for Kaz.
  std::vector<std::string> other_joints = {};
  double ball_radius_m = 0.020;       // of the ball that `detector` detects
  std::string camera = "the camera";  // as messages name it
  // Without an image for this long a behaviour fails. Before that it waits, standing (kLostCamera).
  Time camera_patience = std::chrono::seconds(2);
  // Null without a camera and for behaviours without needs_floor.
  FloorDetector* floor = nullptr;
  // Null where nobody can ask for anything.
  Requests* requests = nullptr;
};

// Result of a behaviour. Measurements are written to result.json; their names contain the units.
struct Outcome {
  bool success = false;
  std::string sentence;  // for display: "the ball was found after 1.4 s"
  std::vector<std::pair<std::string, double>> measurements;
  // Class of a failure, for tables: "not found", "fell". Empty on success.
  std::string cause = {};
};

struct Behavior {
  std::string_view name;      // "track-ball"
  std::string_view text;      // one line
  bool needs_camera = false;  // run() uses Context::detector
  std::span<const Option> options = {};
  // An outcome without success: the task failed. An Error: it could not be completed (link, camera,
  // usage); one of Fault::failed counts as a failure.
  Result<Outcome> (*run)(Context& context) = nullptr;
  bool needs_floor = false;     // run() uses Context::floor
  bool takes_requests = false;  // run() uses Context::requests
};

// All behaviours of behaviors.def, in its order.
std::span<const Behavior> behaviors();
// Fails (usage) with a sentence that lists the names.
Result<Behavior> find_behavior(std::string_view name);

#define KAZ_BEHAVIOR(source, behavior) extern const Behavior behavior;
#include "host/behavior/behaviors.def"
#undef KAZ_BEHAVIOR

}  // namespace kaz::behavior
