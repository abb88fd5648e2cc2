// Orderly end of a program on Ctrl-C and termination: motors off, files closed, links removed.
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

// Signals within this time count as one. A terminal signals its whole process group, and a wrapper
// (`timeout`, a shell) forwards the signal that it received. A supervisor or a closing terminal sends a
// second one soon after the first.
inline constexpr std::chrono::milliseconds kOneSignal{400};

// Installs handlers of SIGINT, SIGTERM and SIGHUP. The first signal requests the interrupt of the newest
// InterruptSignals; without one the program exits at once. A second signal, after kOneSignal, always exits at
// once. The exit status is 128 + signal. If SIGHUP was ignored (nohup), it stays ignored.
void catch_signals();

// Sets the command name ("kaz eyes") that an exit at once prints. Only one thread may call these functions.
void name_verb(const std::string& verb);
std::string named_verb();  // "kaz" before name_verb()
// Sets the sentence that an exit at once prints: which state is left changed, and how to restore it. "":
// none.
void leaves_behind(const std::string& sentence);
// Sets a function that an exit at once calls first; null: none. It runs in a signal handler, so it may only
// call async-signal-safe functions. Only one thread may call this.
void does_at_last(void (*last)() noexcept);

// Makes an exit at once remove the file, which has no result yet. Returns a number for keep_what_grows() and
// forget_file(), or -1 if the table is full or the path too long. Both functions accept -1. Only one thread
// may call these functions.
int remove_file_at_last(const std::string& path);
// From now on, removes the file only if it is empty: partial content is useful.
void keep_what_grows(int number);
// Stops tracking the file.
void forget_file(int number);

// Returns the received signal (SIGINT) and its name ("SIGINT"); 0 and "no signal" if none was received.
int received_signal() noexcept;
const char* received_signal_name() noexcept;
// Resets the received signal, for a process that continues after an interrupted run.
void forget_signal() noexcept;

// Returns the exit status for an error: the value of its fault, plus the signal number for
// Fault::interrupted.
int exit_status(const Error& error);

// Marks a result that an interrupt has truncated: "interrupted": true, "signal": "SIGINT".
void mark_interrupted(nlohmann::ordered_json& result);

// Signals request `interrupt` while this object lives; an earlier signal requests it at once. With several
// objects the newest is active. The constructor also calls catch_signals() and ignores SIGPIPE. `interrupt`
// must outlive the object.
class InterruptSignals {
 public:
  explicit InterruptSignals(host::Interrupt& interrupt);
  ~InterruptSignals();
  InterruptSignals(const InterruptSignals&) = delete;
  InterruptSignals& operator=(const InterruptSignals&) = delete;

  // Resets this state in a child after fork(): the parent's interrupt, exit function, files to remove and
  // received signal.
  static void forget_earlier();

 private:
  host::Interrupt* outer_;
};

}  // namespace kaz::tools
