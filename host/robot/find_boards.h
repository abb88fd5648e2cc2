// Searches a line for boards at all 14 addresses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "host/robot/robot_types.h"
#include "shared/protocol/messages.h"

namespace kaz::host {

struct FindOptions {
  // Waiting time after the request to each address. A reply takes 3 ms.
  Time each = std::chrono::milliseconds(25);
  // Additional waiting time after the last address, because some adapters deliver bytes late.
  Time last = std::chrono::milliseconds(120);
  int rounds = 2;  // maximum number of rounds; the search ends after the first round with a reply
};

// Sends `identify` to each address. Returns the addresses at which a board answered, in ascending order. The
// only effect on the boards is that their link watchdogs restart. Fails if the link is lost or the program is
// interrupted.
Result<std::vector<std::uint8_t>> find_boards(Link& link, Clock& clock,
                                              const FindOptions& options = {});

// Returns a text such as "address 3" or "addresses 1, 3 and 5".
std::string addresses_text(const std::vector<std::uint8_t>& addresses);

// Explains why the board at `address` did not reply. `error`: the error of the failed request. If only boards
// at other addresses answer, returns an error message with these addresses. `advice`: text before the address
// that the user should choose. Otherwise returns `error`.
Error explain_silence(Link& link, Clock& clock, std::uint8_t address, Error error,
                      const std::string& advice = kAddressAdvice);

}  // namespace kaz::host
