// Ctrl-C and termination end a program in order: motors off, files closed, links removed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/link/interrupt.h"
#include "host/link/interruptible.h"
#include "shared/base/result.hpp"

namespace kaz::tools {

using host::InterruptibleClock;
using host::InterruptibleLink;

// Signals within this time are one: a terminal signals its whole process group, and a wrapper (`timeout`, a
// shell) forwards what it got; a supervisor or a closing terminal sends a second one behind the first.
inline constexpr std::chrono::milliseconds kOneSignal{400};

// From now on the first SIGINT, SIGTERM or SIGHUP requests the interrupt of the newest InterruptSignals;
// where there is none the program ends at once. A second one, after kOneSignal, always does. The exit status
// is 128 + signal. SIGHUP stays ignored where it was (nohup).
void catch_signals();

// What a program that ends at once prints: its verb ("kaz eyes"), and what is not as it was and how to mend
// it; "" if nothing is. One thread.
void name_verb(const std::string& verb);
std::string named_verb();  // "kaz" before name_verb()
void leaves_behind(const std::string& sentence);
// What a program that ends at once does before; null: nothing. Runs in a signal handler, so only functions
// that are async-signal-safe. One thread.
void does_at_last(void (*last)() noexcept);

// A program that ends at once removes the file before: it has no result yet. Returns a number for the other
// two, which take -1 too: there are more such files than are kept count of. One thread.
int remove_file_at_last(const std::string& path);
// Only while it is empty: what has grown in it is of use.
void keep_what_grows(int number);
void forget_file(int number);

// The signal that came, 0 if none: SIGINT and "SIGINT".
int received_signal() noexcept;
const char* received_signal_name() noexcept;
// For a process that goes on after an interrupted run.
void forget_signal() noexcept;

// What the program's status is for an error: its fault, and for an interrupted one 128 + signal.
int exit_status(const Error& error);

// Marks a result that an interrupt has cut short: "interrupted": true, "signal": "SIGINT".
void mark_interrupted(nlohmann::ordered_json& result);

// While it lives signals request `interrupt`; a signal that came before it does so at once. The newest in a
// process counts.
class InterruptSignals {
 public:
  explicit InterruptSignals(host::Interrupt& interrupt);
  ~InterruptSignals();
  InterruptSignals(const InterruptSignals&) = delete;
  InterruptSignals& operator=(const InterruptSignals&) = delete;

  // In a child after fork(): no interrupt of the parent's is requested from here, what it does at last is not
  // done, and no signal came yet.
  static void forget_earlier();

 private:
  host::Interrupt* outer_;
};

}  // namespace kaz::tools
