// `kaz monitor`: 18 joints, supply, tick and link in a terminal, and keys to move them.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/cli/options.h"
#include "tools/cli/verbs.h"
#include "tools/cli/watch_options.h"
#include "tools/monitor/monitor.h"

namespace kaz::tools {

void add_monitor(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand("monitor",
                                      "show a board's joints, supply, tick and link in the "
                                      "terminal; keys move and stop the joints");
  auto arguments = std::make_shared<MonitorOptions>();
  auto watch = std::make_shared<WatchArguments>();
  add_required_port(*verb, arguments->port);
  add_address(*verb, arguments->address);
  verb->add_option("--robot-file", arguments->robot_file,
                   "URDF of a robot other than Kaz; for a servo bus (feetech:PATH[@BAUD] or "
                   "dynamixel:PATH[@BAUD]), the file bus.json must be in the folder of the URDF")
      ->type_name("FILE");
  add_watch_options(*verb, *watch, false);
  verb->remove_option(verb->get_option("--view-wait"));
  verb->footer(
      "A terminal with 80 columns and 24 lines is enough, also over ssh. Before you press a key, "
      "the monitor sends only read requests. The key e switches the selected joint on or off; E "
      "switches all joints on. The left and right arrow keys move the joint by one degree. The "
      "keys '[' and ']' move the joint by five degrees. SPACE stops all motors, and c clears a "
      "shutdown. The key q switches off the motors that the monitor switched on, and then ends the "
      "monitor. The board must answer at the start; if the board is lost later, the monitor "
      "connects again as soon as possible.\n"
      "Exit status: 0 ended by q, Ctrl-C, SIGTERM or SIGHUP, 2 wrong usage or no terminal, 3 port "
      "error.\n"
      "Examples:\n"
      "  kaz monitor --robot serial:/dev/ttyUSB0\n"
      "  kaz sim --mcu native --serial board     # in another terminal; wait for ready\n"
      "  kaz monitor --robot serial:board\n"
      "  kaz monitor --robot serial:board --view        # also in a browser\n"
      "  kaz monitor --robot feetech:/dev/ttyACM0 --robot-file so101.urdf\n"
      "  ssh workbench -t kaz monitor --robot serial:/dev/ttyUSB0");
  verb->callback([&action, arguments, watch] {
    action = [arguments, watch] { return monitor_watched(*watch, *arguments); };
  });
}

}  // namespace kaz::tools
