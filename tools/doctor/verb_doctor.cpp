// `kaz doctor`: examines this machine's ports, CAN interfaces and cameras.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/doctor/doctor.h"

namespace kaz::tools {

void add_doctor(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "doctor", "check this machine's ports, CAN interfaces, cameras, drivers and cores");
  auto options = std::make_shared<DoctorOptions>();
  auto* port = add_port(
      *verb, options->port,
      std::string("also identify the board at this port and check the board's firmware: ") +
          kPortText);
  add_address(*verb, options->address)->needs(port);
  verb->add_flag("--json", options->json, "print the findings as JSON");
  verb->footer(
      "Each finding is marked good, note (something could be better) or wrong (something does not "
      "work). If a command can correct the problem, Kaz prints this command below the finding. kaz "
      "doctor opens no serial port except the port in --robot, because some adapters reset the "
      "board when a program opens the port. Run kaz doctor as root to find devices that programs "
      "of other users hold open.\n"
      "Exit status: 0 no finding has the mark `wrong`; 1 a finding has this mark.\n"
      "Examples:\n"
      "  kaz doctor\n"
      "  kaz doctor --robot serial:/dev/ttyUSB0\n"
      "  kaz doctor --json");
  verb->callback([&action, options] { action = [options] { return run_doctor(*options); }; });
}

}  // namespace kaz::tools
