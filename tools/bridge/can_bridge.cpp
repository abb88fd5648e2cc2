// `kaz can-bridge`: a board's serial line on a CAN bus.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bridge/can_bridge.h"

#include <cstdio>

#include "host/link/can_link.h"
#include "host/link/line_bridge.h"
#include "host/robot/find_boards.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"

namespace kaz::tools {

Result<bool> bridge_can(const CanBridgeOptions& options) {
  const auto port = KAZ_TRY(parse_port(options.port));
  if (port.kind == host::PortKind::can)
    return fail(Fault::usage,
                "--robot " + options.port + ": is already a CAN bus; give the board's serial line");
  // "can:can0" too, as for --robot.
  const auto bus = KAZ_TRY(host::parse_port_address(
      "--can",
      options.interface.starts_with("can:") ? options.interface : "can:" + options.interface));
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  auto line = KAZ_TRY(host::open_port(port, &interrupt));
  auto can = KAZ_TRY(host::CanLink::open(
      host::kernel_can_sockets(bus.place),
      {.end = host::CanLink::End::board, .addresses = options.addresses, .interrupt = &interrupt}));
  const auto say = [](const std::string& sentence) {
    std::printf("%s\n", sentence.c_str());
    std::fflush(stdout);
  };
  host::LineBridge bridge(*line, *can, interrupt, say);
  say("ready: " + host::addresses_text(options.addresses) + " of " + line->name() + " on " +
      can->name() + "; Ctrl-C ends");
  KAZ_TRY(bridge.run());
  const std::string counts = can->counts();
  say(bridge.counts() + (counts.empty() ? "" : "; " + can->name() + ": " + counts));
  return true;
}

}  // namespace kaz::tools
