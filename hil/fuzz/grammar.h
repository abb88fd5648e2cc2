// The fuzzer's grammar: turns a string of bytes into actions of a hostile host.
// SPDX-License-Identifier: Apache-2.0
//
// A string of bytes, called the genome, determines a case. Each decision (next action, message, value)
// consumes some bytes, and the case ends when no bytes are left. Every string is a valid case, and a small
// change of the string changes the case only a little. Therefore a coverage-guided fuzzer can mutate the
// string. Messages, fields and bounds come from the protocol's table (shared/protocol/message_info.h).
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
  std::vector<std::uint8_t> bytes;  // bytes on the wire, for the kinds `send` and `query`
  int ms = 0;                       // duration of an event of the kind `wait`
  // Only for an event of the kind `fault`: the fault that begins at this event. Fault::at is ignored.
  faults::Fault fault;
  std::string text;  // description, one line
};

struct GrammarOptions {
  bool faults = true;  // whether cases have faults of sensors, power and mechanics
  bool line_faults = true;
  // Whether cases have requests that write the board's flash.
  bool flash = true;
  int longest_ms = 2000;                      // approximate maximum duration of a case
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // board address
};

// Returns the events of a case. A `query` event is one legal request with silence before and after. The board
// must send exactly one reply to this request.
std::vector<Event> events_of(std::span<const std::uint8_t> genome, const GrammarOptions& options);

// Returns the case as readable text, one line per event.
std::string text_of(std::span<const Event> events);

}  // namespace kaz::hil::fuzz
