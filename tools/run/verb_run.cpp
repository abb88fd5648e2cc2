// `kaz run`: one behavior on a real or virtual robot.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "host/behavior/behavior.h"
#include "host/behavior/plugin.h"
#include "tools/base/output.h"
#include "tools/cli/help.h"
#include "tools/cli/options.h"
#include "tools/cli/run_options.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {
namespace {

// Returns the behaviors with the option `seconds`, and its range in each: "track-ball (0.1 to 86400)".
std::string timed_behaviors() {
  std::string list;
  for (const auto& behavior : behavior::behaviors()) {
    for (const auto& option : behavior.options) {
      if (option.name == "seconds")
        list += (list.empty() ? "" : ", ") + std::string(behavior.name) + " (" +
                behavior::valid_values(option) + ")";
    }
  }
  return list;
}

// Returns the default world of each behavior, for the help text.
std::string default_worlds() {
  const std::string_view common = behavior::Behavior{}.world;
  std::string list;
  for (const auto& one : behavior::behaviors()) {
    if (one.world == common) continue;
    list += "world '" + std::string(one.world) + "' for " +
            (list.empty() ? "the behavior '" : "'") + std::string(one.name) + "', ";
  }
  return list + "world '" + std::string(common) + "' for all other behaviors";
}

// Options of the virtual robot, which have no effect on one at a port.
constexpr const char* kVirtualOnly[] = {
    "--world",           "--mcu",           "--image",  "--sensors", "--imu",       "--no-imu",
    "--dynamics",        "--physics-step",  "--supply", "--eyes",    "--eye-width", "--renderer",
    "--record-pictures", "--restore-every", "--memory", "--strict"};

// Errors: nothing is drawn at a port. Behaviors that look choose the side on which they begin by the seed,
// and so may plug-ins; faults of the line have chances.
Result<void> check_seed(const CLI::App& verb, const std::string& behavior,
                        const std::string& robot) {
  if (verb.count("--seed") == 0 || verb.count("--faults") > 0 || behavior::names_plugin(behavior))
    return {};
  const auto known = behavior::find_behavior(behavior);
  if (!known || known->needs_camera) return {};
  return fail(Fault::usage, "--seed has no effect: " + behavior +
                                " uses no random numbers, and a robot at a port has no " +
                                "simulated noise; leave --seed out with --robot " + robot);
}

// Errors: an option was given that has no effect on this kind of robot.
Result<void> check_given(const CLI::App& verb, const std::string& behavior,
                         const std::string& robot) {
  if (robot == "sim" && verb.count("--address") > 0)
    return fail(Fault::usage,
                "--address is only valid with a port, such as --robot serial:PATH; the virtual "
                "board has address 1");
  if (robot == "sim") return {};
  for (const char* option : kVirtualOnly) {
    if (verb.count(option) > 0)
      return fail(Fault::usage, std::string(option) + " is for the virtual robot; leave " + option +
                                    " out with --robot " + robot);
  }
  return check_seed(verb, behavior, robot);
}

// Errors: an option beside --options, which runs nothing.
Result<void> check_alone(const CLI::App& verb) {
  for (const CLI::Option* option : verb.get_options()) {
    if (option->count() > 0 && option->nonpositional() && option->get_name() != "--options")
      return fail(Fault::usage,
                  option->get_name() +
                      " is not valid with --options, which only prints the options; leave " +
                      option->get_name() + " or --options out");
  }
  return {};
}

// A behavior and its options.
std::string behavior_text(const behavior::Behavior& behavior) {
  std::string text = "  " + std::string(behavior.name) + ": " + std::string(behavior.text) + "\n";
  for (const auto& option : behavior.options) {
    text += "      " + std::string(option.name) + " (" + std::string(option.initial) + "; " +
            behavior::valid_values(option) + "): " + std::string(option.text) + "\n";
  }
  return text;
}

// Options that set an option of some behaviors. The help shows them only for these behaviors.
struct Shortcut {
  const char *option, *sets;
};
constexpr Shortcut kShortcuts[] = {
    {"--duration", "seconds"}, {"--goal", "goal"}, {"--poses", "poses"}};

// `shown`: group of the options that the help shows. Null: no behavior was named.
void show_shortcuts(CLI::App& verb, const behavior::Behavior* behavior, const std::string& shown) {
  for (const auto& [option, sets] : kShortcuts) {
    const bool has =
        behavior != nullptr &&
        std::ranges::count(behavior->options, std::string_view(sets), &behavior::Option::name) > 0;
    verb.get_option(option)->group(has ? shown : kHiddenGroup);
  }
}

constexpr const char* kExamples[] = {
    "  kaz run search-ball\n",
    "  kaz run track-ball --seed 3 --duration 12 --out three\n",
    "  kaz run catch-ball --world catch --eyes real --imu --out caught\n",
    "  kaz run navigate --goal 1.2,0.1 --world boxes --eyes real --imu --out there\n",
    "  kaz run track-ball --robot serial:board --camera board.eyes     # port of kaz sim\n",
    "  kaz run pose --view              # set joints and make poses in the browser\n",
    "  kaz run play --poses wave.json\n",
    "  kaz run ./wave.so --set times=2\n",
    "  kaz run ./wave.so --options\n",
    "  kaz run track-ball --robot serial:/dev/ttyUSB0 \\\n"
    "      --camera v4l2:/dev/video0,/dev/video2 --calibration stereo.yml\n"};

// Those of the behavior; of all, if null.
std::string examples_of(const behavior::Behavior* behavior) {
  std::string examples;
  const std::string begin = behavior ? "  kaz run " + std::string(behavior->name) : "";
  for (const std::string example : kExamples) {
    if (example.starts_with(begin + " ") || example.starts_with(begin + "\n") || !behavior)
      examples += example;
  }
  if (!examples.empty()) return examples;
  if (behavior->options.empty()) return begin + "\n";
  const behavior::Option& first = behavior->options.front();
  return begin + " --set " + std::string(first.name) + "=" + std::string(first.initial) + "\n";
}

// Returns the end of the help text: the options of `behavior`, or the list of behaviors if it is null.
std::string footer(const behavior::Behavior* behavior) {
  std::string text;
  if (behavior != nullptr) {
    text = "The behavior and its options (--set NAME=VALUE), with default and valid values:\n" +
           behavior_text(*behavior);
  } else {
    text = "Behaviors (`kaz run NAME --help` shows the options of a behavior):\n";
    for (const auto& one : behavior::behaviors())
      text += "  " + std::string(one.name) + ": " + std::string(one.text) + "\n";
    text +=
        "To write your own behavior, see docs/howto/own-behavior.md. A plug-in runs with your user "
        "rights.\n";
  }
  return text +
         "Options of the virtual robot, such as --world or --mcu, are not valid with a robot at a "
         "port (--robot serial:PATH). With a robot at a port, the file in --faults can contain "
         "only faults of the serial line. --robot-file describes the joints of a robot other than "
         "Kaz, also at a port.\n"
         "Examples:\n" +
         examples_of(behavior);
}

}  // namespace

void add_run(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("run", "run one behavior on a real or virtual robot");
  auto arguments = std::make_shared<RunArguments>();
  auto& run = arguments->run;
  verb->add_option("BEHAVIOR", run.behavior, "name of a behavior, or a plug-in such as ./NAME.so")
      ->required()
      ->type_name("");
  verb->add_option("--robot", run.backend.robot, kRobotText)
      ->type_name("sim|PORT")
      ->capture_default_str();
  add_address(*verb, run.backend.address);
  verb->add_option("--camera", run.backend.camera,
                   "source of the pictures: sim, the path of a camera socket, or "
                   "v4l2:LEFT,RIGHT[,fps=N][,format=NAME]")
      ->type_name("CAMERA")
      ->capture_default_str();
  verb->add_option("--calibration", run.backend.calibration,
                   "for v4l2 cameras: calibration file written by kaz calibrate stereo, or "
                   "LEFT.yaml,RIGHT.yaml of ROS; the file also sets the size of the pictures")
      ->type_name("FILE");
  verb->add_option("--reconnect", run.backend.reconnect_s,
                   "at a port: maximum time to reconnect after the link is lost")
      ->check(between(0, 3600))
      ->capture_default_str()
      ->type_name("SECONDS");
  add_choice(*verb, "--when-lost", host::kReactions, run.backend.reaction,
             "reaction of the board if no request arrives for 90 ms: keep the posture (hold), or "
             "switch the motors off (limp)");
  add_out(*verb, *arguments, "; without --out, no file is written");
  add_duration(*verb, *arguments,
               "the same as --set seconds=SECONDS, for " + timed_behaviors() +
                   "; the other behaviors end by themselves");
  verb->add_option("--goal", arguments->goal, "the same as --set goal=..., for navigate")
      ->type_name("X,Y[,DEGREES]|ball");
  verb->add_option(
          "--poses", arguments->poses,
          "file of poses for the behavior 'play' (see docs/howto/watch.md and `kaz run pose "
          "--view`)")
      ->type_name("FILE");
  add_settings(*verb, arguments->settings, "an option of the behavior (kaz run NAME --help)");
  auto list = std::make_shared<bool>(false);
  verb->add_flag("--options", *list, "print the options of the behavior or plug-in, and exit");
  verb->add_flag("--profile", run.profile,
                 "measure the CPU time and waiting time of each part of the program; print a table "
                 "and add the table to result.json");
  add_run_options(*verb, *arguments);
  verb->get_option("--record-pictures")->needs("--out");  // else there is no recording
  const std::string shown = verb->get_option("--robot")->get_group();
  show_shortcuts(*verb, nullptr, shown);
  auto chosen = std::make_shared<std::optional<behavior::Behavior>>();
  // Before --help is answered.
  verb->get_option("BEHAVIOR")->each([verb, chosen, shown](const std::string& name) {
    const auto known = behavior::find_behavior(name);
    if (!known || behavior::names_plugin(name)) return;
    *chosen = *known;
    show_shortcuts(*verb, &**chosen, shown);
  });
  verb->footer([chosen] { return footer(*chosen ? &**chosen : nullptr); });
  verb->get_option("--world")->default_str(default_worlds());
  verb->callback([&action, arguments, verb, list] {
    action = [arguments, verb, list]() -> Result<ExitStatus> {
      if (*list) {
        KAZ_TRY(check_alone(*verb));
        const auto behavior = KAZ_TRY(behavior::named_behavior(arguments->run.behavior));
        print_lines("%s", behavior_text(behavior).c_str());
        return ExitStatus();
      }
      KAZ_TRY(check_given(*verb, arguments->run.behavior, arguments->run.backend.robot));
      if (verb->count("--world") == 0) {
        // If the behavior is unknown, run_behavior() fails.
        if (const auto known = behavior::named_behavior(arguments->run.behavior))
          arguments->run.backend.world = known->world;
      }
      return run_behavior(*arguments);
    };
  });
}

}  // namespace kaz::tools
