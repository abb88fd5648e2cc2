// Discards bytes received before a request, so that they are not taken for its reply.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/link.h"

namespace kaz::host {

// Reads and discards available bytes without waiting for more. Returns the link's errors. Fails (environment)
// if bytes still arrive after 64 KiB or 100 ms, as from a device that sends on its own.
Result<void> drain(Link& link, Clock& clock);

}  // namespace kaz::host
