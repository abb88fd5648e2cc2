// `kaz eyes`: what both eyes and an onlooker see, as pictures.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "sim/render/sensor/sensor.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/drawing/figure.h"
#include "tools/run/robot_joints.h"
#include "tools/sim/draw_eyes.h"

namespace kaz::tools {

void add_eyes(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "eyes", "draw what both eyes and an outside observer see at the start of a run");
  auto arguments = std::make_shared<EyesOptions>();
  arguments->backend.mcu = sim::McuKind::native;
  verb->add_option("--out", arguments->out, "folder for the pictures")
      ->type_name("DIR")
      ->capture_default_str();
  add_sim_options(*verb, arguments->backend);
  // All kinds of eyes are drawn, and nothing moves.
  for (const char* useless : {"--eyes", "--mcu", "--image", "--faults", "--sensors", "--imu",
                              "--no-imu", "--supply", "--dynamics", "--physics-step"})
    verb->remove_option(verb->get_option(useless));
  verb->footer(
      "The view of each eye is drawn three times: as a pinhole camera sees it, with the errors of "
      "lens and sensor, and after rectification.\n"
      "Examples:\n"
      "  kaz eyes\n"
      "  kaz eyes --world ball --eye-width 640 --out big");
  verb->callback([&action, arguments] {
    action = [arguments] {
      print_unused("kaz eyes", files_of(arguments->backend));
      return draw_eyes(*arguments);
    };
  });
}

}  // namespace kaz::tools
