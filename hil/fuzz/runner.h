// One case of the fuzzer on one board, over any port.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "hil/fuzz/conversation.h"
#include "hil/fuzz/grammar.h"
#include "host/link/link.h"

namespace kaz::hil::fuzz {

struct Verdict {
  std::optional<std::string> violation;
  std::set<std::uint32_t>
      features;  // codes of board behaviour reached: coverage that guides the search
  ConversationCounts counts;
  double seconds = 0;  // on the clock
};

struct RunnerOptions {
  // Makes a fault happen; where there is none, cases must be made without faults.
  std::function<void(const faults::Fault&)> fault;
  // What else has been found wrong so far, looked at after each event.
  std::function<std::optional<std::string>()> judge;
  // How long a lonely request may take to be answered.
  Time patience = std::chrono::milliseconds(100);
  Time longest_start = std::chrono::seconds(3);
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // of the board
  // What a case that an error ends has done until then, without a judgement; may be null.
  Verdict* broken_off = nullptr;
};

// Waits until the board answers, applies the events, and checks once more that it answers;
// then all
// motors are off. Errors: nothing answers at the start, the link is gone, the program was
// interrupted.
Result<Verdict> run_case(host::Link& link, host::Clock& clock, std::span<const Event> events,
                         const RunnerOptions& options);

}  // namespace kaz::hil::fuzz
