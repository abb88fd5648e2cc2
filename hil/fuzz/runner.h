// Runs one fuzzing case on one board, over any port.
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

struct CaseVerdict {
  std::optional<std::string> violation;
  // Codes for the kinds of board behavior that occurred during the case. These codes are the coverage that
  // guides the search.
  std::set<std::uint32_t> features;
  ConversationCounts counts;
  double seconds = 0;  // duration on the clock of run_case()
};

struct RunnerOptions {
  // Injects a fault. If `fault` is null, the cases must contain no faults.
  std::function<void(const faults::Fault&)> fault;
  // An additional check, called after each event. Returns the violation that this check found, or nullopt.
  // May be null.
  std::function<std::optional<std::string>()> judge;
  // Timeout for the reply to a query.
  Time patience = std::chrono::milliseconds(100);
  Time longest_start = std::chrono::seconds(3);
  std::uint8_t address = KZ_ADDRESS_DEFAULT;  // board address
  // If the case ends with an error, the statistics of the case are stored here. The stored CaseVerdict has no
  // violation. May be null.
  CaseVerdict* broken_off = nullptr;
};

// Waits until the board answers, applies the events, and checks again that the board answers. Then switches
// all motors off. Returns at once after a violation. Errors: the board does not answer at the start, the link
// is lost, or the program was interrupted.
Result<CaseVerdict> run_case(host::Link& link, host::Clock& clock, std::span<const Event> events,
                             const RunnerOptions& options);

}  // namespace kaz::hil::fuzz
