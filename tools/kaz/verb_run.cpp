// `kaz demo` and `kaz run`: one behaviour on a robot.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string_view>

#include "host/behavior/behavior.h"
#include "tools/kaz/color_file.h"
#include "tools/kaz/session.h"
#include "tools/kaz/sim_options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {
namespace {

std::string behavior_names() {
  std::string names;
  for (const auto& behavior : behavior::behaviors()) {
    names += (names.empty() ? "" : ", ") + std::string(behavior.name);
  }
  return names;
}

// Behaviours and their options, for the help text.
std::string behavior_list() {
  std::string list = "Behaviours and their options (--set NAME=VALUE):\n";
  for (const auto& behavior : behavior::behaviors()) {
    list += "  " + std::string(behavior.name) + ": " + std::string(behavior.text) + "\n";
    for (const auto& option : behavior.options) {
      list += "      " + std::string(option.name) + " (" + std::string(option.initial) +
              "): " + std::string(option.text) + "\n";
    }
  }
  return list;
}

// What both verbs have in common.
struct RunArguments {
  SessionOptions session;
  std::vector<std::string> settings;
  std::string duration;
  std::string color;  // file
};

void add_common(CLI::App& verb, RunArguments& arguments) {
  add_sim_options(verb, arguments.session.backend);
  add_record_pictures(verb, arguments.session.backend);
  verb.add_option(
      "--duration", arguments.duration,
      "seconds of the robot: for search-ball in all, for track-ball from when the ball was found");
  verb.add_option("--set", arguments.settings, "an option of the behaviour: NAME=VALUE")
      ->type_name("NAME=VALUE");
  verb.add_option(
          "--restore-every", arguments.session.backend.restore_every_s,
          "proof of saved states: every so many seconds the virtual robot is saved, goes on "
          "unrecorded for 0.1 s and is restored; the recording must not show it")
      ->check(CLI::Range(0.001, 1e6))
      ->type_name("SECONDS");
  verb.add_option("--modules", arguments.session.vision.modules,
                  "of vision that run beside it: " + module_names() +
                      ", with commas between; color always does")
      ->capture_default_str();
  verb.add_option("--color", arguments.color,
                  "of the ball, from kaz vision learn-color; without it the red ball's")
      ->type_name("FILE");
  verb.add_option("--radius", arguments.session.vision.ball.radius_m, "of the ball, m")
      ->check(CLI::Range(0.005, 0.5))
      ->capture_default_str();
  verb.add_flag("--json", arguments.session.json,
                "print the result as JSON on standard output, no progress");
}

// Errors: the behaviour ends by itself; the text is no number that it takes.
Result<void> check_duration(const behavior::Behavior& behavior, const std::string& text) {
  const auto option =
      std::ranges::find(behavior.options, std::string_view("seconds"), &behavior::Option::name);
  if (option == behavior.options.end())
    return fail(Fault::usage, "--duration: " + std::string(behavior.name) +
                                  " ends by itself; leave the option out");
  if (behavior::OptionValues::parse(std::span(&*option, 1), {{"seconds", text}})) return {};
  char range[80];
  std::snprintf(range, sizeof range, "from %g to %g, as in --duration %s", option->min,
                option->max, std::string(option->initial).c_str());
  return fail(Fault::usage, "--duration " + text + ": give a number of seconds " + range);
}

Result<bool> start(RunArguments arguments) {
  for (const auto& setting : arguments.settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) {
      return fail(Fault::usage, "--set " + setting + ": give NAME=VALUE, as in --set seconds=20");
    }
    arguments.session.settings[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
  if (!arguments.duration.empty()) {
    const auto behavior = behavior::find_behavior(arguments.session.behavior);
    if (!behavior) return tl::unexpected(behavior.error());
    if (auto sound = check_duration(*behavior, arguments.duration); !sound)
      return tl::unexpected(sound.error());
    arguments.session.settings["seconds"] = arguments.duration;
  }
  if (!arguments.color.empty()) {
    const auto color = read_color(arguments.color);
    if (!color) return tl::unexpected(color.error());
    arguments.session.vision.ball.color = *color;
  }
  return run_session(arguments.session);
}

}  // namespace

void add_demo(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "demo", "the main job in lockstep: the robot searches the ball and keeps its head on it");
  auto arguments = std::make_shared<RunArguments>();
  arguments->session.label = "kaz demo";
  arguments->session.out = "kaz-demo";
  verb->add_option("--out", arguments->session.out, "folder for pictures and result.json")
      ->capture_default_str();
  add_common(*verb, *arguments);
  verb->footer(
      "Leaves left_eye.png, color_extraction.png, outside.png, moments.png (and "
      ".jpg),\npan_tilt.png, "
      "recording.mcap and result.json. The recording holds bytes, pins, joints, contacts and the "
      "rest "
      "on\none clock: `kaz replay` runs it again; Foxglove (foxglove.dev), PlotJuggler and `mcap "
      "info` "
      "open it.\n"
      "Examples:\n"
      "  kaz demo\n"
      "  kaz demo --seed 7 --out seven\n"
      "  kaz demo --modules depth,planes --record-pictures\n"
      "  kaz demo --mcu native --duration 10 --json");
  verb->callback([&action, arguments] { action = [arguments] { return start(*arguments); }; });
}

void add_run(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("run", "one behaviour on a real or virtual robot");
  auto arguments = std::make_shared<RunArguments>();
  auto& session = arguments->session;
  verb->add_option("BEHAVIOUR", session.behavior, "one of: " + behavior_names())
      ->required()
      ->type_name("");
  verb->add_option("--robot", session.backend.robot, "sim, or serial:PATH[@BAUD]")
      ->capture_default_str();
  verb->add_option("--camera", session.backend.camera,
                   "sim, the path of a camera socket, or v4l2:LEFT,RIGHT[,fps=N][,format=NAME]")
      ->capture_default_str();
  verb->add_option("--calibration", session.backend.calibration,
                   "of v4l2 cameras (kaz calibrate stereo); it says which size they are run at")
      ->type_name("FILE");
  verb->add_option("--out", session.out, "folder for pictures and result.json; none if not given");
  add_common(*verb, *arguments);
  verb->get_option("--record-pictures")->needs("--out");  // else there is no recording
  verb->footer(behavior_list() +
               "Examples:\n"
               "  kaz run search-ball\n"
               "  kaz run track-ball --seed 3 --duration 12 --out three\n"
               "  kaz run catch-ball --world catch --eyes real --imu --out caught\n"
               "  kaz run track-ball --robot serial:/dev/ttyUSB0 --camera board.eyes\n"
               "  kaz run track-ball --robot serial:/dev/ttyUSB0 \\\n"
               "      --camera v4l2:/dev/video0,/dev/video2 --calibration stereo.yml\n"
               "With a port nothing of the simulator is used; --world, --mcu, --image and --seed "
               "are then\nwithout effect.");
  verb->callback([&action, arguments] { action = [arguments] { return start(*arguments); }; });
}

}  // namespace kaz::tools
