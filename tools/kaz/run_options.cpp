// The options of `kaz demo` and `kaz run`.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/run_options.h"

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "host/behavior/behavior.h"
#include "host/behavior/plugin.h"
#include "tools/app/base/arguments.h"
#include "tools/app/vision/color_file.h"
#include "tools/kaz/options.h"

namespace kaz::tools {
namespace {

// Errors: the behaviour ends by itself; the text is no number that it takes.
Result<void> check_duration(const behavior::Behavior& behavior, const std::string& text) {
  const auto option =
      std::ranges::find(behavior.options, std::string_view("seconds"), &behavior::Option::name);
  if (option == behavior.options.end())
    return fail(Fault::usage, "--duration: " + std::string(behavior.name) +
                                  " ends by itself; leave the option out");
  if (behavior::OptionValues::parse(std::span(&*option, 1), {{"seconds", text}})) return {};
  char range[80];
  std::snprintf(range, sizeof range, "from %g to %g, as in --duration %s", option->min, option->max,
                std::string(option->initial).c_str());
  return fail(Fault::usage, "--duration " + text + ": give a number of seconds " + range);
}

}  // namespace

void add_run_options(CLI::App& verb, RunArguments& arguments) {
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

Result<bool> run_behavior(RunArguments arguments) {
  const auto settings = KAZ_TRY(parse_settings(arguments.settings));
  arguments.session.settings = settings;
  if (!arguments.duration.empty()) {
    const auto behavior = KAZ_TRY(behavior::named_behavior(arguments.session.behavior));
    KAZ_TRY(check_duration(behavior, arguments.duration));
    arguments.session.settings["seconds"] = arguments.duration;
  }
  if (!arguments.color.empty()) {
    const auto color = KAZ_TRY(read_color(arguments.color));
    arguments.session.vision.ball.color = color;
  }
  return run_session(arguments.session);
}

}  // namespace kaz::tools
