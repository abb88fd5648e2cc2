// A TCP connection as a link.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/tcp_link.h"

#include <utility>

#include "host/link/tcp_socket.h"

namespace kaz::host {

namespace {

constexpr Time kFirst = std::chrono::seconds(3), kAgain = std::chrono::milliseconds(500);

}  // namespace

Result<std::unique_ptr<TcpLink>> TcpLink::open(const PortAddress& address,
                                               const Interrupt* interrupt) {
  std::unique_ptr<TcpLink> link(new TcpLink(address, interrupt));
  link->stream_.attach(
      KAZ_TRY(connect_tcp(address.name(), address.place, address.tcp_port, kFirst, interrupt)));
  return link;
}

TcpLink::TcpLink(PortAddress address, const Interrupt* interrupt)
    : address_(std::move(address)),
      interrupt_(interrupt),
      stream_(address_.name(),
              address_.name() +
                  " was closed by the other end: its board was unplugged, its server "
                  "ended, or another program has it",
              interrupt) {}

Result<void> TcpLink::set_dtr_rts(bool, bool) {
  return fail(Fault::environment, name() +
                                      " carries bytes alone, and no lines DTR and RTS: serve "
                                      "the port by RFC 2217 and give rfc2217:HOST:PORT");
}

Result<void> TcpLink::reopen() {
  if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
  stream_.detach();
  stream_.attach(
      KAZ_TRY(connect_tcp(address_.name(), address_.place, address_.tcp_port, kAgain, interrupt_)));
  return {};
}

}  // namespace kaz::host
