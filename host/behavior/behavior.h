// Behaviors: closed-loop programs that run unchanged on real and virtual robots.
// SPDX-License-Identifier: Apache-2.0
//
// A behavior is a function of Context. A behavior blocks only in calls of the robot and the clock. Such calls
// fail if the link fails, the camera stops or the program is interrupted. If a call fails, the behavior
// returns the error at once. The behavior does not switch the motors off, because the caller of run() calls
// Robot::disable_all() at the end.
//
// A new behavior needs one source file, which defines a `const Behavior`, and one line in behaviors.def. Then
// it can be run, drawn and evaluated, because programs read everything else from Behavior.
// Alternatively, a behavior is a shared object (plugin.h). docs/howto/own-behavior.md shows an example.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/behavior/options.h"
#include "host/behavior/sink.h"
#include "host/behavior/vision.h"
#include "host/robot/robot.h"

namespace kaz::behavior {

// Source of the requests that a behavior receives while the behavior runs.
class Requests {
 public:
  virtual ~Requests() = default;
  // Returns the requests that arrived since the last call, one line each. `now` is the time stamp of the
  // requests in the recording.
  virtual std::vector<std::string> take(Time now) = 0;
};

// Objects and values that a behavior uses. The references are valid until run() returns.
struct Context {
  host::Robot& robot;
  host::Clock& clock;
  // Null if the run has no camera. Never null for behaviors whose needs_camera is true.
  Vision* vision;
  Sink& sink;
  OptionValues options;
  std::uint64_t seed = 1;  // seed of random choices
  // Joint names of a robot other than Kaz; the index is the channel of the board. For Kaz, this list is
  // empty.
  std::vector<std::string> other_joints = {};
  double ball_radius_m = 0.020;       // radius of the ball that `vision` detects
  std::string camera = "the camera";  // name of the camera in error messages
  // Timeout of the camera: a behavior fails after this time without an image. If no image has come for
  // ControlCycle::kLostCamera, the robot stops and waits for the next image.
  Time camera_patience = std::chrono::seconds(2);
  // Null if the run has no source of requests.
  Requests* requests = nullptr;
};

// Result of a behavior. The measurements are written to result.json. The name of a measurement contains the
// unit.
struct Outcome {
  bool success = false;
  std::string sentence;  // text for display, such as "the ball was found after 1.4 s"
  std::vector<std::pair<std::string, double>> measurements;
  // Class of a failure, for tables: "not found", "fell". Empty on success.
  std::string cause = {};
};

// Moment of a run that is worth a picture.
struct Milestone {
  std::string_view phase;  // as reported to Sink::phase(); each phase has at most one milestone
  std::string_view name;   // name of the picture
  // Time from the first start of the phase to the moment, s. If the phase ends earlier, its end counts.
  double after_s = 0;
};

// Condition for success of an evaluated run. The evaluator measures, with its own bounds
// (tools/eval/judge.h). If a criterion needs an option of the behavior, its comment names the option.
enum class Criterion {
  claim,           // the behavior reports success
  ball_direction,  // the measurements ball_bearing_deg and ball_elevation_deg are true
  ball_tracked,    // the left eye looks at the ball; `seconds`
  ball_in_reach,   // the ball is in front of a hand
  ball_held,       // the ball is above the floor
  upright,         // the robot stands
  walked,          // the robot walked straight; `distance`, m
  turned_left,     // the robot turned on the spot; `angle`, degrees
  turned_right,
  at_goal,  // the robot reached the goal without touching an obstacle; `goal`, as for navigate
};

// Start and surroundings of an evaluated run.
enum class Stage {
  ball,    // the robot stands, with a ball and distractors around
  lying,   // the robot lies on an empty floor
  course,  // the robot stands in front of obstacles; needs the option `goal` of navigate
};

// Evaluation of a behavior by `kaz evaluate`.
struct Evaluation {
  Criterion criterion = Criterion::claim;  // built-in behaviors with `claim` are not evaluated
  Stage stage = Stage::ball;
  // False: the robot takes no steps, so the times of pushes count from the start of the run.
  bool walks = true;
};

struct Behavior {
  std::string_view name;      // such as "track-ball"
  std::string_view text;      // description, one line
  bool needs_camera = false;  // run() uses Context::vision
  std::span<const Option> options = {};
  // Returns an Outcome without success if the task failed. Returns an Error if the task could not be
  // completed (link, camera, usage). An Error with Fault::failed counts as a failure of the task.
  Result<Outcome> (*run)(Context& context) = nullptr;
  bool needs_floor = false;     // run() uses Vision::take_floor()
  bool takes_requests = false;  // run() uses Context::requests
  // Default world of `kaz run`, which contains the objects that the behavior needs.
  std::string_view world = "ball";
  // Empty: pictures show only the phase `track`, at four times.
  std::span<const Milestone> milestones = {};
  Evaluation evaluation = {};
};

// All behaviors of behaviors.def, in the order of that file.
std::span<const Behavior> behaviors();
// Returns the behavior of this name. Fails (usage) if the name is unknown; the message lists the known names.
Result<Behavior> find_behavior(std::string_view name);

#define KAZ_BEHAVIOR(source, behavior) extern const Behavior behavior;
#include "host/behavior/behaviors.def"
#undef KAZ_BEHAVIOR

}  // namespace kaz::behavior
