// `kaz doctor`: examines this machine's ports, CAN interfaces and cameras.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/app/doctor/doctor.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {

void add_doctor(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "doctor", "examine this machine's ports, CAN interfaces, cameras, drivers and cores");
  auto options = std::make_shared<DoctorOptions>();
  verb->add_flag("--json", options->json, "print the findings as JSON");
  verb->footer(
      "Each finding is good, a note (it could be better) or wrong, with the command that mends it. "
      "Serial "
      "ports are not opened: some adapters would reset the board. Programs of other users that "
      "hold "
      "a device are found by root alone.\n"
      "Exit status: 0 nothing is wrong, 1 something is.\n"
      "Examples:\n"
      "  kaz doctor\n"
      "  kaz doctor --json");
  verb->callback([&action, options] { action = [options] { return run_doctor(*options); }; });
}

}  // namespace kaz::tools
