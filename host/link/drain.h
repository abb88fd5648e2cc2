// Discards bytes received before a request, so that these bytes are not taken for the reply.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/link.h"

namespace kaz::host {

// Reads and discards available bytes without waiting for more bytes. Returns the link's errors. Fails
// (environment) if bytes still arrive after 64 KiB or 100 ms. A device that sends on its own causes this
// failure.
Result<void> drain(Link& link, Clock& clock);

}  // namespace kaz::host
