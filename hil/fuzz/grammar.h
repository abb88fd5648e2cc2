// From a string of bytes to what a hostile host does: the fuzzer's grammar.
// SPDX-License-Identifier: Apache-2.0
//
// A case is a string of bytes, its genome: each decision (what next, which message, which value)
// takes
// some of them, and the case ends with them. So every string is a case, a small change of the
// string is a
// small change of the case, and a coverage-guided fuzzer can work on the string. Messages, fields
// and
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
  std::vector<std::uint8_t> bytes;  // of send and query, as they go to the wire
  int ms = 0;                       // of wait
  faults::Fault fault;              // its time counts from the event
  std::string text;                 // one line for people
};

struct GrammarOptions {
  bool faults = true;  // of sensors, power and mechanics
  bool line_faults = true;
  bool flash = true;                          // requests that wear the board's flash
  int longest_ms = 2000;                      // of the case
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // of the board
};

// `query`: one legal request with silence before and after, to which exactly one reply must come.
std::vector<Event> events_of(std::span<const std::uint8_t> genome, const GrammarOptions& options);

// The whole case for people, one line an event.
std::string text_of(std::span<const Event> events);

}  // namespace kaz::hil::fuzz
