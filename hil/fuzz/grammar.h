// The fuzzer's grammar: turns a string of bytes into actions of a hostile host.
// SPDX-License-Identifier: Apache-2.0
//
// A case is a string of bytes, its genome. Each decision (next action, message, value) consumes some bytes,
// and the case ends when no bytes are left. So every string is a case, and a small change of the string is a
// small change of the case. Therefore a coverage-guided fuzzer can mutate the string. Messages, fields and
// bounds come from the protocol's table (shared/protocol/message_info.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/faults/faults.h"
#include "shared/protocol/messages.h"

namespace kaz::hil::fuzz {

using Genome = std::vector<std::uint8_t>;

struct Event {
  enum class Kind { send, wait, query, fault };
  Kind kind = Kind::wait;
  std::vector<std::uint8_t> bytes;  // for send and query: bytes on the wire
  int ms = 0;                       // for wait
  faults::Fault fault;              // for fault; time `at` counts from the event
  std::string text;                 // one readable line
};

struct GrammarOptions {
  bool faults = true;  // faults of sensors, power and mechanics
  bool line_faults = true;
  bool flash = true;                          // requests that write the board's flash
  int longest_ms = 2000;                      // approximate maximum duration of a case
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // board address
};

// Returns the events of a case. A `query` event is one legal request with silence before and after. Exactly
// one reply must come to the request.
std::vector<Event> events_of(std::span<const std::uint8_t> genome, const GrammarOptions& options);

// Returns the case as readable text, one line per event.
std::string text_of(std::span<const Event> events);

}  // namespace kaz::hil::fuzz
