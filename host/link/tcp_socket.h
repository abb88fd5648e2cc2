// TCP connections: opening, listening, and a sentence for each cause of failure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "host/link/interrupt.h"
#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz::host {

// A connected, non-blocking socket: bytes leave at once (TCP_NODELAY), and a peer that is gone without a word
// is an error after about a second. `name` ("tcp:bench:7000") is for messages. Errors (environment): no such
// host, connection refused, no route, no answer within `patience`, interrupted.
Result<Descriptor> connect_tcp(const std::string& name, const std::string& host, std::uint16_t port,
                               Time patience, const Interrupt* interrupt);

// A listening, non-blocking socket at "HOST:PORT" of this machine. Errors: in use, not an address of this
// machine, permission (ports below 1024).
Result<Descriptor> listen_tcp(const std::string& host, std::uint16_t port);
// The next client, "192.168.1.4:51234" in `peer`; an empty descriptor if there is none.
Descriptor accept_tcp(int listener, std::string& peer);
// Of a listening socket; that of the kernel's choice where it was opened with 0.
std::uint16_t port_of(int listener);

}  // namespace kaz::host
