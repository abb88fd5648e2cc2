// `kaz doctor`: examines this machine's ports, CAN interfaces and cameras.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/app/doctor/doctor.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

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
      "Each finding is good, a note (it could be better) or wrong, with the command that fixes it. "
      "Only the serial port of --robot is opened, because some adapters would reset the board. "
      "Only root can find programs of other users that hold a device.\n"
      "Exit status: 0 no fault found, 1 a fault was found.\n"
      "Examples:\n"
      "  kaz doctor\n"
      "  kaz doctor --robot serial:/dev/ttyUSB0\n"
      "  kaz doctor --json");
  verb->callback([&action, options] { action = [options] { return run_doctor(*options); }; });
}

}  // namespace kaz::tools
