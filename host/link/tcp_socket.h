// Opens, listens for and accepts TCP connections.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "host/link/interrupt.h"
#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz::host {

// Returns a connected, non-blocking socket. The socket sends written bytes at once (TCP_NODELAY) and detects
// a vanished peer after about a second. `name` ("tcp:bench:7000") appears in error messages. Fails
// (environment) if the host is unknown, refuses the connection, is unreachable, or does not answer within
// `patience`. Also fails if interrupted.
Result<Descriptor> connect_tcp(const std::string& name, const std::string& host, std::uint16_t port,
                               Time patience, const Interrupt* interrupt);

// Returns a listening, non-blocking socket at "HOST:PORT" of this machine. Fails (environment) if the port is
// in use, or if the port is below 1024 and the user has no permission. Fails (usage) if this machine does not
// have the address.
Result<Descriptor> listen_tcp(const std::string& host, std::uint16_t port);
// Returns the next client's socket and its address in `peer`: "192.168.1.4:51234". If no client is waiting,
// or if accept() fails, returns an empty descriptor and sets errno.
Descriptor accept_tcp(int listener, std::string& peer);
// Returns the port of a listening socket. For a socket that was opened with port 0, returns the port that the
// kernel selected.
std::uint16_t port_of(int listener);

}  // namespace kaz::host
