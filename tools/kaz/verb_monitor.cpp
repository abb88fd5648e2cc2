// `kaz monitor`: 18 joints, supply, tick and link in a terminal, and keys to move them.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "tools/app/monitor/monitor.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"
#include "tools/kaz/watch_options.h"

namespace kaz::tools {

void add_monitor(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "monitor", "show a board in the terminal: joints, supply, tick, link; keys to move and stop");
  auto arguments = std::make_shared<MonitorOptions>();
  auto watch = std::make_shared<WatchArguments>();
  add_required_port(*verb, arguments->port);
  add_address(*verb, arguments->address);
  verb->add_option("--robot-file", arguments->robot_file,
                   "URDF of another robot than Kaz; of a bus of servos, feetech:PATH[@BAUD] or "
                   "dynamixel:PATH[@BAUD], with bus.json beside it")
      ->type_name("FILE");
  add_watch_options(*verb, *watch, false);
  verb->remove_option(verb->get_option("--view-wait"));
  verb->footer(
      "80 columns and 24 lines are enough; works over ssh. It reads only, until a key is pressed: "
      "e switches the selected joint on or off, E all on, left and right move it by a degree, [ "
      "and "
      "] by five, SPACE stops everything, c clears a shutdown, q quits and switches off what was "
      "switched on here. A board that goes away is sought until it is there again; at the start it "
      "has to be there.\n"
      "Exit status: 0 left by q, Ctrl-C, SIGTERM or SIGHUP, 2 wrong usage or no terminal, 3 port "
      "error.\n"
      "Examples:\n"
      "  kaz monitor --robot serial:/dev/ttyUSB0\n"
      "  kaz sim --mcu native --serial board     # in another terminal, until it says ready\n"
      "  kaz monitor --robot serial:board\n"
      "  kaz monitor --robot serial:board --view        # the robot in a browser, too\n"
      "  kaz monitor --robot feetech:/dev/ttyACM0 --robot-file so101.urdf\n"
      "  ssh workbench -t kaz monitor --robot serial:/dev/ttyUSB0");
  verb->callback([&action, arguments, watch] {
    action = [arguments, watch] { return monitor_watched(*watch, *arguments); };
  });
}

}  // namespace kaz::tools
