// Client of the simulator's control socket: reset, mode pins and other signals that a pty cannot transfer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/interrupt.h"
#include "shared/base/result.hpp"

namespace kaz::host {

// Sends one request (docs/reference/simulator.md) to the socket `path` and returns the reply, a JSON object.
// Fails (environment) if no server listens, no reply comes within 5 s, or the request is refused. Also fails
// if interrupted. `interrupt` may be null.
Result<std::string> query_control_socket(const std::string& path, const std::string& line,
                                         const Interrupt* interrupt = nullptr);

}  // namespace kaz::host
