// `kaz can-bridge`: puts a board's serial line on a CAN bus.
// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tools/bridge/can_bridge.h"
#include "tools/cli/options.h"
#include "tools/cli/verbs.h"

namespace kaz::tools {

void add_can_bridge(CLI::App& program, Action& action) {
  auto* verb = program.add_subcommand(
      "can-bridge",
      "connect a board's serial line, real or emulated, to a CAN bus (SocketCAN, ISO-TP)");
  auto arguments = std::make_shared<CanBridgeOptions>();
  add_required_port(*verb, arguments->port,
                    "the board's serial line: serial:PATH[@BAUD] of a serial port or pty, "
                    "tcp:HOST:PORT or rfc2217:HOST:PORT[@BAUD]");
  verb->add_option("--can", arguments->interface, "CAN interface, which must be up")
      ->type_name("NAME")
      ->required();
  verb->add_option_function<std::vector<int>>(
          "--address",
          [arguments](const std::vector<int>& all) {
            arguments->addresses.assign(all.begin(), all.end());
          },
          "addresses of the boards on the serial line; each address must be unique on the CAN bus")
      ->check(between(1, KZ_ADDRESS_LAST))
      ->delimiter(',')
      ->type_name("N")
      ->default_str("1");
  verb->footer(
      "While the bridge runs, `--robot can:can0` reaches the board from every machine on the bus. "
      "The page docs/reference/links.md lists the CAN identifiers. The page also lists the "
      "information that a serial line transmits and a CAN bus loses, such as pauses between bytes. "
      "If the line or the bus is lost, the bridge connects again as soon as possible.\n"
      "Exit status: 0 ended by Ctrl-C, SIGTERM or SIGHUP, 2 wrong usage, 3 port or interface "
      "error.\n"
      "Examples:\n"
      "  sudo ip link set can0 up type can bitrate 1000000 restart-ms 100\n"
      "  kaz can-bridge --robot serial:/dev/ttyUSB0 --can can0\n"
      "  kaz can-bridge --robot serial:/dev/ttyUSB1 --can can0 --address 2,3\n"
      "  kaz status --robot can:can0");
  verb->callback([&action, arguments] { action = [arguments] { return bridge_can(*arguments); }; });
}

}  // namespace kaz::tools
