// Orderly end of a program after Ctrl-C or a termination signal: motors off, files closed, links removed.
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

// Signals that arrive within this time after the first signal are ignored. One Ctrl-C may arrive twice: a
// terminal signals its whole process group, and a wrapper (`timeout`, a shell) forwards the signal. A
// supervisor or a closing terminal also sends a second signal soon after the first.
inline constexpr std::chrono::milliseconds kOneSignal{400};

// Installs handlers of SIGINT, SIGTERM and SIGHUP. The first signal requests the interrupt of the newest
// InterruptSignals object; if there is no such object, the program exits at once. A second signal, after
// kOneSignal, always exits at once. The exit status is 128 + signal. If SIGHUP was ignored before (nohup),
// SIGHUP stays ignored.
void catch_signals();

// Sets the command name ("kaz eyes") that an immediate exit prints. Only one thread may call name_verb() and
// named_verb().
void name_verb(const std::string& verb);
std::string named_verb();  // returns "kaz" until name_verb() is called
// Sets the sentence that an immediate exit prints. The sentence states which changes remain, and how to undo
// these changes. An empty sentence is not printed.
void leaves_behind(const std::string& sentence);
// Sets the function that an immediate exit calls first; null: no function. The function runs in a signal
// handler, so it may call only async-signal-safe functions. Only one thread may call does_at_last().
void does_at_last(void (*last)() noexcept);

// Makes an immediate exit remove the file at `path` if the file is empty then. Returns a number for
// forget_file(), or -1 if the table is full or the path is too long. forget_file() accepts -1. Only one
// thread may call these two functions.
int remove_empty_file_at_last(const std::string& path);
// After this call, an immediate exit no longer removes the file.
void forget_file(int number);

// Return the number of the received signal, and its name, for example "SIGINT". If no signal was received,
// the functions return 0 and "no signal".
int received_signal() noexcept;
const char* received_signal_name() noexcept;
// Forgets the received signal. A process that continues after an interrupted run must call this function.
void forget_signal() noexcept;

// Returns the exit status for an error: the value of its fault. For Fault::interrupted the number of the
// signal is added.
int exit_status(const Error& error);

// Adds two members to a result that an interrupt has truncated: "interrupted": true and, for example,
// "signal": "SIGINT".
void mark_interrupted(nlohmann::ordered_json& result);

// While this object exists, a signal requests `interrupt`. If a signal was received before, the constructor
// requests `interrupt`. If several objects exist, only the newest is active. The constructor also calls
// catch_signals() and ignores SIGPIPE. `interrupt` must outlive the object.
class InterruptSignals {
 public:
  explicit InterruptSignals(host::Interrupt& interrupt);
  ~InterruptSignals();
  InterruptSignals(const InterruptSignals&) = delete;
  InterruptSignals& operator=(const InterruptSignals&) = delete;

  // Call this function in a child after fork(). Clears the state inherited from the parent: interrupt, exit
  // function, files to remove and received signal.
  static void forget_earlier();

 private:
  host::Interrupt* outer_;
};

}  // namespace kaz::tools
