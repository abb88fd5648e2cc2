// The options of `kaz demo` and `kaz run`.
// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/run_options.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "host/behavior/behavior.h"
#include "host/behavior/plugin.h"
#include "host/motion/pose_sequence.h"
#include "shared/base/files.hpp"
#include "tools/base/arguments.h"
#include "tools/cli/options.h"
#include "tools/vision/color_file.h"

namespace kaz::tools {
namespace {

// Errors: the behavior ends by itself; the text is no number that it takes; `set` is another one.
Result<void> check_duration(const behavior::Behavior& behavior, const std::string& text,
                            const std::map<std::string, std::string>& set) {
  const auto option =
      std::ranges::find(behavior.options, std::string_view("seconds"), &behavior::Option::name);
  if (option == behavior.options.end())
    return fail(Fault::usage, "--duration is not valid with " + std::string(behavior.name) +
                                  ", which ends by itself; leave --duration out");
  if (const auto seconds = set.find("seconds"); seconds != set.end() && seconds->second != text)
    return fail(Fault::usage, "--duration " + text + " and --set seconds=" + seconds->second +
                                  " contradict each other; leave one out");
  if (behavior::OptionValues::parse(std::span(&*option, 1), {{"seconds", text}})) return {};
  return fail(Fault::usage, "--duration " + text + ": give a number of seconds in the range " +
                                behavior::valid_values(*option) + ", as in --duration " +
                                std::string(option->initial));
}

bool has_option(const behavior::Behavior& behavior, std::string_view option) {
  return std::ranges::count(behavior.options, option, &behavior::Option::name) > 0;
}

// Errors: this behavior has no use for --`option`.
Result<void> check_has(const behavior::Behavior& behavior, const std::string& option) {
  if (has_option(behavior, option)) return {};
  std::string names;
  for (const auto& other : behavior::behaviors()) {
    if (has_option(other, option)) names += (names.empty() ? "" : ", ") + std::string(other.name);
  }
  return fail(Fault::usage, "--" + option + " is only valid with " + names);
}

// Errors: it is set to something else already.
Result<void> set_once(std::map<std::string, std::string>& settings, const std::string& name,
                      const std::string& value, const std::string& given) {
  const auto [set, added] = settings.try_emplace(name, value);
  if (added || set->second == value) return {};
  return fail(Fault::usage, "--" + name + " " + given + " and --set " + name + "=" + set->second +
                                " contradict each other; leave one out");
}

}  // namespace

void add_run_options(CLI::App& verb, RunArguments& arguments) {
  add_sim_options(verb, arguments.run.backend);
  add_record_pictures(verb, arguments.run.backend);
  verb.add_option("--memory", arguments.memory,
                  "file with the virtual board's calibration, written by kaz calibrate joints "
                  "--memory or kaz sim --memory")
      ->type_name("FILE");
  verb.add_option("--restore-every", arguments.run.backend.restore_every_s,
                  "self-test: at this interval, save the virtual robot's state, simulate 0.1 s "
                  "without recording, and restore the state. The recording must not change")
      ->check(between(0.001, 1e6, "s"))
      ->type_name("SECONDS");
  verb.add_option("--modules", arguments.run.vision.modules,
                  "vision modules to run, separated by commas: " + module_names() +
                      ". Only behaviors that use the cameras run them, always with 'color'")
      ->type_name("LIST")
      ->capture_default_str();
  verb.add_option("--color", arguments.color,
                  "file with the ball's color, written by kaz vision learn-color (default: red)")
      ->type_name("FILE");
  verb.add_option("--radius", arguments.run.vision.ball.radius_m, "radius of the ball, m")
      ->check(between(0.005, 0.5, "m"))
      ->capture_default_str()
      ->type_name("M");
  add_watch_options(verb, arguments.watch);
  verb.add_flag("--json", arguments.run.json,
                "print the result as JSON on standard output, without progress messages");
}

CLI::Option* add_duration(CLI::App& verb, RunArguments& arguments, const std::string& text) {
  return verb.add_option("--duration", arguments.duration, text)->type_name("SECONDS");
}

void add_out(CLI::App& verb, RunArguments& arguments, const std::string& more) {
  verb.add_option("--out", arguments.run.out,
                  "folder for recording.mcap, pictures and result.json" + more)
      ->type_name("DIR")
      ->capture_default_str();
}

Result<bool> run_behavior(RunArguments arguments) {
  auto settings = KAZ_TRY(parse_settings(arguments.settings));
  RunOptions& run = arguments.run;
  KAZ_TRY(behavior::load_settings(run.behavior, settings));
  run.settings = settings;
  if (!arguments.duration.empty() || !arguments.goal.empty() || !arguments.poses.empty()) {
    const auto behavior = KAZ_TRY(behavior::named_behavior(run.behavior));
    if (!arguments.goal.empty()) KAZ_TRY(check_has(behavior, "goal"));
    if (!arguments.poses.empty()) KAZ_TRY(check_has(behavior, "poses"));
    if (!arguments.duration.empty()) {
      KAZ_TRY(check_duration(behavior, arguments.duration, settings));
      run.settings["seconds"] = arguments.duration;
    }
  }
  if (!arguments.goal.empty())
    KAZ_TRY(set_once(run.settings, "goal", arguments.goal, arguments.goal));
  if (!arguments.poses.empty()) {
    // The recording has the poses, not the file's name: it may be another one when they are replayed.
    const auto text = KAZ_TRY(read_whole_file(arguments.poses, motion::kMaxPosesBytes));
    const auto poses = KAZ_TRY(motion::parse_poses(text, arguments.poses));
    KAZ_TRY(set_once(run.settings, "poses", motion::text_of(poses), arguments.poses));
  }
  if (!arguments.memory.empty()) run.backend.memory = KAZ_TRY(read_memory(arguments.memory));
  if (!arguments.color.empty()) {
    const auto color = KAZ_TRY(read_color(arguments.color));
    run.vision.ball.color = color;
  }
  return run_watched(arguments.watch, std::move(run));
}

}  // namespace kaz::tools
