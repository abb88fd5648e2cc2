// `kaz serve-port`: the port of a board for clients on other machines.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/app/bridge/serve_port.h"
#include "tools/kaz/options.h"
#include "tools/kaz/verbs.h"

namespace kaz::tools {

void add_serve_port(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "serve-port", "serve a board's port, real or emulated, to one client on the network");
  auto arguments = std::make_shared<ServePortOptions>();
  add_required_port(*verb, arguments->port);
  verb->add_option("--listen", arguments->listen,
                   "address of this machine and port; other machines reach 0.0.0.0, not 127.0.0.1")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  verb->add_flag("--raw", arguments->raw,
                 "bytes alone, for tcp:HOST:PORT; without it RFC 2217, for rfc2217:HOST:PORT");
  verb->footer(
      "The port has no authentication: a client that can connect can move the robot. Keep it on "
      "127.0.0.1 and let ssh carry it, or use a network of the robot's own. A client that begins "
      "with text, as a web browser does, is disconnected. One client at a time; others are "
      "refused. A port that goes away is opened again when it is back.\n"
      "Exit status: 0 ended by Ctrl-C, SIGTERM or SIGHUP, 2 wrong usage, 3 port error.\n"
      "Examples:\n"
      "  kaz serve-port --robot serial:/dev/ttyUSB0\n"
      "  kaz serve-port --robot serial:board --raw --listen 0.0.0.0:7000   # of kaz sim --serial "
      "board\n"
      "  ssh -L 7217:localhost:7217 robot kaz serve-port --robot serial:/dev/ttyUSB0\n"
      "  kaz run track-ball --robot rfc2217:localhost:7217 --camera board.eyes");
  verb->callback([&action, arguments] { action = [arguments] { return serve_port(*arguments); }; });
}

}  // namespace kaz::tools
