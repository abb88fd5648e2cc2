// Searches a line for boards at all 14 addresses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

struct FindOptions {
  Time each = std::chrono::milliseconds(25);   // from one address to the next; a reply takes 3 ms
  Time last = std::chrono::milliseconds(120);  // after the last one: adapters deliver late
  int rounds = 2;                              // until a board has answered
};

// Sends `identify` to each address and returns those from which a reply came, ascending. Changes nothing
// but a board's link watchdog, which each request restarts. Errors: the link is gone, the program was
// interrupted.
Result<std::vector<std::uint8_t>> find_boards(Link& link, Clock& clock,
                                              const FindOptions& options = {});

// "address 3", "addresses 1, 3 and 5"
std::string addresses_text(const std::vector<std::uint8_t>& addresses);

// `error`, of a board at `address` that did not answer; where boards answer at other addresses, one
// sentence that names them and the option to use.
Error explain_silence(Link& link, Clock& clock, std::uint8_t address, Error error);

}  // namespace kaz::host
