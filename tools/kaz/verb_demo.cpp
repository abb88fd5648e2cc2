// `kaz demo`: the robot searches the ball and tracks it, in lockstep.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/kaz/run_options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {

void add_demo(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "demo", "the main job in lockstep: the robot searches the ball and keeps its head on it");
  auto arguments = std::make_shared<RunArguments>();
  arguments->session.label = "kaz demo";
  arguments->session.out = "kaz-demo";
  verb->add_option("--out", arguments->session.out, "folder for pictures and result.json")
      ->capture_default_str();
  add_run_options(*verb, *arguments);
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
  verb->callback(
      [&action, arguments] { action = [arguments] { return run_behavior(*arguments); }; });
}

}  // namespace kaz::tools
