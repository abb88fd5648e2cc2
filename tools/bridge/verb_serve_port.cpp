// `kaz serve-port`: the port of a board for clients on other machines.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/bridge/serve_port.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {

void add_serve_port(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "serve-port", "serve a board's port, real or emulated, to one client on the network");
  auto arguments = std::make_shared<ServePortOptions>();
  add_required_port(*verb, arguments->port);
  verb->add_option("--listen", arguments->listen,
                   "address and port of this machine at which Kaz accepts clients. With 127.0.0.1, "
                   "only programs on this machine can connect; with 0.0.0.0, other machines can "
                   "connect too")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  verb->add_flag("--raw", arguments->raw,
                 "serve raw bytes, for clients that use --robot tcp:HOST:PORT. Without --raw, the "
                 "protocol is RFC 2217, for clients that use --robot rfc2217:HOST:PORT");
  verb->footer(
      "The port has no authentication: every client that can connect can move the robot. Keep the "
      "port on 127.0.0.1 and forward the port with ssh, or use a separate network for the robot. "
      "Kaz disconnects a client whose first bytes are text, such as a web browser. Only one client "
      "can be connected at a time; other clients are rejected. If the connection to the board is "
      "lost, Kaz connects again as soon as possible.\n"
      "Exit status: 0 ended by Ctrl-C, SIGTERM or SIGHUP, 2 wrong usage, 3 port error.\n"
      "Examples:\n"
      "  kaz serve-port --robot serial:/dev/ttyUSB0\n"
      "  kaz serve-port --robot serial:board --raw --listen 0.0.0.0:7000   # port of kaz sim "
      "--serial board\n"
      "  ssh -L 7217:localhost:7217 robot kaz serve-port --robot serial:/dev/ttyUSB0\n"
      "  kaz run track-ball --robot rfc2217:localhost:7217 --camera board.eyes");
  verb->callback([&action, arguments] { action = [arguments] { return serve_port(*arguments); }; });
}

}  // namespace kaz::tools
