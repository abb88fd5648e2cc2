// `kaz status`: prints a board's state. Reads only; moves and changes nothing.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/board/board_status.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {

void add_status(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "status", "print a board's state: motors, cause of a shutdown, supply, link");
  auto arguments = std::make_shared<StatusOptions>();
  add_required_port(*verb, arguments->port);
  add_address(*verb, arguments->address);
  verb->add_flag("--json", arguments->json, "print the state as JSON");
  verb->footer(
      "The command `kaz status` only reads data: no motor moves, and no fault is cleared. After a "
      "shutdown, see docs/explanation/safety.md.\n"
      "In JSON, 'since_reset_s' is the time since the board's last reset, and 'last_reset' is the "
      "cause of this reset. The field 'shutdown_at_s' is the time from the board's last reset to "
      "the shutdown. The field 'build' is a number that identifies the sources of the firmware; "
      "`kaz flash info` prints the same number. The field 'firmware_fault' is present only for "
      "firmware that is known to be unsafe.\n"
      "Exit status: 0 no shutdown is latched, 1 a shutdown is latched, 2 wrong usage, 3 port "
      "error.\n"
      "Examples:\n"
      "  kaz status --robot serial:/dev/ttyUSB0\n"
      "  kaz status --robot serial:/dev/ttyUSB0 --address 3 --json");
  verb->callback(
      [&action, arguments] { action = [arguments] { return print_status(*arguments); }; });
}

}  // namespace kaz::tools
