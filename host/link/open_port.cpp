// Opens a port by its address.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/can_link.h"
#include "host/link/port_link.h"
#include "host/link/rfc2217_link.h"
#include "host/link/tcp_link.h"
#include "host/link/tty_link.h"

namespace kaz::host {

Result<std::unique_ptr<PortLink>> open_port(const PortAddress& address,
                                            const Interrupt* interrupt) {
  switch (address.kind) {
    case PortKind::can:
      return CanLink::open(kernel_can_sockets(address.place), {.interrupt = interrupt});
    case PortKind::tcp:
      return TcpLink::open(address, interrupt);
    case PortKind::rfc2217:
      return Rfc2217Link::open(address, interrupt);
    case PortKind::serial:
    default:
      return TtyLink::open(address.place, address.baud, interrupt);
  }
}

}  // namespace kaz::host
