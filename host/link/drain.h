// Empties a link before a request, so that old bytes are not taken for its answer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/link.h"

namespace kaz::host {

// Reads and discards what has come, without waiting for more. Errors: the link's; (environment) bytes still
// come after 64 KiB or 100 ms, as from a device that sends on its own.
Result<void> drain(Link& link, Clock& clock);

}  // namespace kaz::host
