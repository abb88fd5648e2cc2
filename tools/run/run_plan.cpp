// Makes the plan of a run.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/run_plan.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "host/behavior/plugin.h"
#include "host/behavior/pose_request.h"
#include "sim/body/description/robot_model.h"
#include "tools/run/option_json.h"
#include "tools/run/robot_joints.h"
#include "tools/run/run_report.h"
#include "tools/vision/color_file.h"

namespace kaz::tools {
namespace {

// The virtual robot, as one JSON object.
std::string robot_facts(BackendOptions backend) {
  nlohmann::ordered_json robot;
  backend.visit(option_json_writer(robot));
  return robot.dump();
}

// Facts that `kaz replay` needs to repeat the run.
std::vector<std::pair<std::string, std::string>> facts_of(const RunOptions& options) {
  const BackendOptions& backend = options.backend;
  std::vector<std::pair<std::string, std::string>> facts{
      {"behavior", options.behavior}, {"settings", nlohmann::json(options.settings).dump()}};
  if (backend.at_port()) {
    facts.emplace_back("port", backend.robot);
  } else {
    facts.emplace_back("backend", robot_facts(backend));
  }
  if (const vision::BallOptions& ball = options.vision.ball; !is_usual(ball)) {
    nlohmann::ordered_json json = color_json(ball.color);
    json["radius_m"] = ball.radius_m;
    facts.emplace_back("ball", json.dump());
  }
  return facts;
}

Result<void> add_needed_modules(const behavior::Behavior& behavior, std::string& modules) {
  const auto names = KAZ_TRY(parse_modules(modules));
  for (const auto& [needed, name] : {std::pair{true, "color"}, {behavior.needs_floor, "floor"}}) {
    if (needed && std::ranges::find(names, name) == names.end())
      modules = std::string(name) + "," + modules;
  }
  return {};
}

// Reads the robot's file, sets the joints, and returns their speed limits. The simulation uses the same
// robot. For a robot at a port, only joints and names are read, and --verbose reads the links later.
Result<std::vector<std::string>> read_robot_file(BackendOptions& backend) {
  if (backend.robot_file.empty()) return std::vector<std::string>();
  sim::ReadOptions reading = backend.reading;
  if (backend.at_port()) reading = {.body = false};
  auto robot = KAZ_TRY(sim::load_robot(backend.robot_file, reading));
  backend.joints = KAZ_TRY(other_joints(robot, backend.robot_file));
  auto speeds = joint_speeds(robot);
  if (!backend.at_port() || !backend.verbose)
    backend.robot_model = std::make_shared<const sim::RobotModel>(std::move(robot));
  return speeds;
}

}  // namespace

Result<RunPlan> RunPlan::make(RunOptions options) {
  RunPlan plan;
  plan.behavior_ = KAZ_TRY(behavior::named_behavior(options.behavior));
  plan.values_ = KAZ_TRY(behavior::OptionValues::parse(plan.behavior_.options, options.settings));
  KAZ_TRY(add_needed_modules(plan.behavior_, options.vision.modules));
  // The behavior would fail with the same error, but only after the results folder was changed.
  if (plan.behavior_.takes_requests && !options.requests)
    return fail(Fault::usage, behavior::kNoRequests);
  BackendOptions& backend = options.backend;
  std::vector<std::string> speeds;
  if (!options.open_backend) {
    speeds = KAZ_TRY(read_robot_file(backend));
    if (!options.quiet) print_unused(options.label, files_of(backend));
  }
  backend.needs_camera = plan.behavior_.needs_camera;
  KAZ_TRY(check(backend));
  plan.target_ = KAZ_TRY(target_of(backend));
  if (!options.open_backend && !plan.on_servo_bus()) backend.joint_speeds = speeds;
  backend.facts = facts_of(options);
  plan.records_in_folder_ =
      !options.out.empty() && backend.recording.empty() && !options.open_backend;
  if (plan.records_in_folder_) backend.recording = growing_recording(options.out);
  plan.options_ = std::move(options);
  return plan;
}

double RunPlan::expected_s() const {
  const bool has_limit = std::ranges::count(behavior_.options, std::string_view("seconds"),
                                            &behavior::Option::name) > 0;
  return has_limit ? values_.number("seconds") : 10;
}

}  // namespace kaz::tools
