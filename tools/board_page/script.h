// A session by a list of commands, and everything that it did as text: to compare builds and engines.
// SPDX-License-Identifier: Apache-2.0
//
//   run MS             advances; then prints time, states, instructions, PC, pins, and digests
//   send TYPE FIELDS   a message to board 1, both in hex; FIELDS may be missing
//   raw BYTES          any bytes, in hex
//   keep MS            heartbeats from now on; 0: no more
//   turn JOINT RAD, release JOINT, press JOINT NM
//   supply V, power 0|1, reset
//   # ...              nothing
#pragma once

#include <string>

#include "tools/board_page/session.h"

namespace kaz::board_page {

// Errors: an invalid command, with its line; the chip stopped.
Result<std::string> run_script(Session& session, const std::string& script);

}  // namespace kaz::board_page
