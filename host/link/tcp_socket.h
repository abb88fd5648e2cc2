// Opens, listens for and accepts TCP connections.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "host/link/interrupt.h"
#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"

namespace kaz::host {

// Returns a connected, non-blocking socket. It sends at once (TCP_NODELAY) and detects a vanished peer after
// about a second. `name` ("tcp:bench:7000") appears in error messages. Fails (environment) if the host is
// unknown, refuses, is unreachable, or does not answer within `patience`; also if interrupted.
Result<Descriptor> connect_tcp(const std::string& name, const std::string& host, std::uint16_t port,
                               Time patience, const Interrupt* interrupt);

// Returns a listening, non-blocking socket at "HOST:PORT" of this machine. Fails if the port is in use or
// below 1024 without permission (environment), or if the address is not of this machine (usage).
Result<Descriptor> listen_tcp(const std::string& host, std::uint16_t port);
// Returns the next client's socket and its address in `peer`: "192.168.1.4:51234". Returns an empty
// descriptor if no client waits or accept() fails; then errno is set.
Descriptor accept_tcp(int listener, std::string& peer);
// The port of a listening socket. If it was opened with 0, the port that the kernel selected.
std::uint16_t port_of(int listener);

}  // namespace kaz::host
