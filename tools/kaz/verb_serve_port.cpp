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
  verb->add_option(
          "--listen", arguments->listen,
          "address of this machine and port; 0.0.0.0 accepts other machines, 127.0.0.1 does not")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  verb->add_flag("--raw", arguments->raw,
                 "serve raw bytes, for clients with tcp:HOST:PORT (default: RFC 2217, for clients "
                 "with rfc2217:HOST:PORT)");
  verb->footer(
      "The port has no authentication: every client that can connect can move the robot. Keep it "
      "on 127.0.0.1 and forward it with ssh, or use a separate network for the robot. A client "
      "that begins with text, such as a web browser, is disconnected. Only one client can be "
      "connected at a time; others are rejected. A lost port is opened again when it is back.\n"
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
