// `kaz serve-port`: the port of a board for clients on other machines.
// SPDX-License-Identifier: Apache-2.0
#include "tools/bridge/serve_port.h"

#include <cstdio>

#include "host/link/line_bridge.h"
#include "host/link/port_server.h"
#include "tools/base/arguments.h"
#include "tools/base/interrupt_signals.h"

namespace kaz::tools {

Result<bool> serve_port(const ServePortOptions& options) {
  const auto port = KAZ_TRY(parse_port(options.port));
  const auto place = host::parse_port_address("--listen", "tcp:" + options.listen);
  if (!place)
    return fail(Fault::usage, "--listen " + options.listen +
                                  ": give HOST:PORT, for example 127.0.0.1:7217 or 0.0.0.0:7217");
  host::Interrupt interrupt;
  const InterruptSignals signals(interrupt);
  const auto say = [](const std::string& sentence) {
    std::printf("%s\n", sentence.c_str());
    std::fflush(stdout);
  };
  auto line = KAZ_TRY(host::open_port(port, &interrupt));
  using Protocol = host::PortServer::Protocol;
  auto server = KAZ_TRY(
      host::PortServer::open(*line, {.host = place->place,
                                     .port = place->tcp_port,
                                     .protocol = options.raw ? Protocol::raw : Protocol::rfc2217,
                                     .interrupt = &interrupt,
                                     .report = say}));
  host::LineBridge bridge(*line, *server, interrupt, say);
  say("ready: " + line->name() + " as " + server->name() + "; Ctrl-C ends");
  KAZ_TRY(bridge.run());
  say(bridge.counts());
  return true;
}

}  // namespace kaz::tools
