// `kaz demo`: the robot finds the ball and follows it with its head, in simulated time.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>

#include "host/behavior/behavior.h"
#include "tools/cli/options.h"
#include "tools/cli/run_options.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {

void add_demo(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "demo", "let the robot find the ball and follow it with its head, in simulated time");
  auto arguments = std::make_shared<RunArguments>();
  arguments->run.label = "kaz demo";
  arguments->run.out = "kaz-demo";
  add_out(*verb, *arguments, "");
  const auto& seconds = *std::ranges::find(behavior::kTrackBall.options,
                                           std::string_view("seconds"), &behavior::Option::name);
  add_duration(*verb, *arguments,
               "how long the robot tracks the ball after finding the ball, " +
                   behavior::valid_values(seconds) + " s")
      ->default_str(std::string(seconds.initial));
  add_settings(*verb, arguments->settings, "an option of track-ball (kaz run track-ball --help)");
  add_run_options(*verb, *arguments);
  verb->footer(
      "The demo runs the behavior track-ball on the virtual robot, as `kaz run track-ball` does. "
      "The demo simulates 23 s, which takes about 10 s on one processor.\n"
      "The demo writes the pictures start.png, end.png, left_eye.png, color_extraction.png, "
      "outside.png, moments.png and moments.jpg. It also writes a plot (pan_tilt.png and "
      "pan_tilt.svg), vision.csv, result.json and recording.mcap. After a failed demo, some of "
      "these files are missing. The recording contains pin states, joint angles, contacts, the "
      "bytes on the serial line, and more data. All times in the recording come from one clock. "
      "`kaz replay` runs the recording again; Foxglove (foxglove.dev), PlotJuggler and `mcap info` "
      "open the recording.\n"
      "Examples:\n"
      "  kaz demo\n"
      "  kaz demo --seed 7 --out seven\n"
      "  kaz demo --modules depth,planes --record-pictures\n"
      "  kaz demo --mcu native --duration 10 --json");
  verb->callback(
      [&action, arguments] { action = [arguments] { return run_behavior(*arguments); }; });
}

}  // namespace kaz::tools
