// Runs code of a plug-in so that this program ends in order whatever that code does.
// SPDX-License-Identifier: Apache-2.0
//
// A plug-in is foreign code in this process. What it throws is an error as others (thrown_error()). But it
// may also crash, throw where nothing catches (in a thread of its own, a static initialiser), call exit(),
// _exit() or abort(), or never return. Then its thread is parked where it is, and a thread of the guard's
// does what has to be done before the process ends.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/behavior/plugin.h"
#include "host/link/interrupt.h"
#include "shared/base/result.hpp"
#include "tools/app/session/call_gate.h"

namespace kaz::tools {

// How a plug-in ends the process, or is ended.
struct PluginEnd {
  // Fault::interrupted: it did not return after an interrupt.
  Error error;
  // "SIGSEGV", "exit(3)", the received signal.
  std::string by;
};

struct PluginGuardOptions {
  std::string label;          // begins messages: "kaz run"
  std::string path;           // of the plug-in
  std::string doing = "run";  // it is "run", "loaded"
  // Exit status of a plug-in that has called exit().
  Fault fault = Fault::failed;
  CallGate* gate = nullptr;
  host::Interrupt* interrupt = nullptr;
  // The last action of this process, but for the message: returns what follows in the sentence. On the
  // guard's thread; the plug-in's is parked, or runs in its own code and finds the gate shut.
  std::function<std::string(const PluginEnd&)> finish = {};
  // Called before a message about a plug-in that is waited for.
  std::function<void()> before_message = {};
};

// One at a time. The thread that makes it runs the plug-in, which may have others.
class PluginGuard {
 public:
  explicit PluginGuard(PluginGuardOptions options);
  // Does not return if the guard is ending the process.
  ~PluginGuard();
  PluginGuard(const PluginGuard&) = delete;
  PluginGuard& operator=(const PluginGuard&) = delete;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// In a handler of all exceptions: the error for the one that is handled, which `who` has thrown.
// Fault::failed; environment if memory ran out.
Error thrown_error(const std::string& who);

// behavior::named_behavior() for a name from the command line: loads a plug-in under a guard. `label`: of
// messages.
Result<behavior::Behavior> guarded_behavior(const std::string& name, const std::string& label);

// To be called by the program's own _exit() and _Exit() before they end it: does not return where a guard
// ends the process.
void before_exit(const char* function, int status);

}  // namespace kaz::tools
