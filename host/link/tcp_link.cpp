// A TCP connection as a link.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/tcp_link.h"

#include <algorithm>
#include <utility>

#include "host/link/tcp_socket.h"
#include "host/link/telnet.h"

namespace kaz::host {

namespace {

constexpr Time kFirst = std::chrono::seconds(3), kAgain = std::chrono::milliseconds(500);

// Two commands of an option, with which a server of Telnet or RFC 2217 begins. For a mistake a board's first
// six bytes would have to be just these.
constexpr std::size_t kTelnetBegin = 6;

bool is_telnet(std::span<const std::uint8_t> first) {
  for (std::size_t i = 0; i < first.size(); ++i) {
    const std::uint8_t byte = first[i];
    if (i % 3 == 0 && byte != telnet::kIac) return false;
    if (i % 3 == 1 && (byte < telnet::kWill || byte > telnet::kDont)) return false;
  }
  return true;
}

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
                  " was closed by the other end: the board was unplugged, the server ended, or "
                  "another program uses the connection",
              interrupt) {}

Result<void> TcpLink::set_dtr_rts(bool, bool) {
  return fail(Fault::environment, name() +
                                      " transfers only bytes, not the lines DTR and RTS: serve "
                                      "the port with RFC 2217 and give rfc2217:HOST:PORT");
}

Result<std::size_t> TcpLink::read(std::span<std::uint8_t> bytes, Time deadline) {
  const auto count = stream_.read(bytes, deadline);
  if (!count || first_.size() == kTelnetBegin) return count;
  const std::size_t more = std::min(*count, kTelnetBegin - first_.size());
  first_.insert(first_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(more));
  if (first_.size() < kTelnetBegin || !is_telnet(first_)) return count;
  return fail(Fault::environment, name() +
                                      ": an RFC 2217 server answers at this address, and its "
                                      "commands are not bytes of the board; give rfc2217:" +
                                      name().substr(name().find(':') + 1));
}

Result<void> TcpLink::reopen() {
  if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
  first_.clear();
  stream_.detach();
  stream_.attach(
      KAZ_TRY(connect_tcp(address_.name(), address_.place, address_.tcp_port, kAgain, interrupt_)));
  return {};
}

}  // namespace kaz::host
