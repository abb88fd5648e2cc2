// Runs the code of a plug-in so that this program ends in order, whatever that code does.
// SPDX-License-Identifier: Apache-2.0
//
// A plug-in is foreign code in this process. An exception that the plug-in throws is handled as an error
// (thrown_error()). But the plug-in may also crash, call exit(), _exit() or abort(), or never return. The
// plug-in may also throw where no handler catches the exception: in its own thread or in a static
// initializer. In all these cases the guard parks the plug-in's thread. The guard's own thread then does the
// necessary work before the process ends.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/behavior/plugin.h"
#include "host/link/interrupt.h"
#include "shared/base/result.hpp"
#include "tools/app/session/call_gate.h"

namespace kaz::tools {

// How a plug-in ended the process, or why the guard ended the process.
struct PluginEnd {
  // The fault is Fault::interrupted if the plug-in did not return after an interrupt.
  Error error;
  // Cause: "SIGSEGV", "exit(3)", or the name of the received signal.
  std::string by;
};

struct PluginGuardOptions {
  std::string label;  // prefix of messages: "kaz run"
  std::string path;   // path of the plug-in
  // Word for messages that states what was done with the plug-in: "run" or "loaded".
  std::string doing = "run";
  // Fault, and thus exit status, if the plug-in calls exit() or throws an exception that no handler catches.
  Fault fault = Fault::failed;
  CallGate* gate = nullptr;
  host::Interrupt* interrupt = nullptr;
  // Called on the guard's thread just before the last message and the end of the process. Returns text to
  // append to this message. Meanwhile the plug-in's thread is parked, or runs in the plug-in's own code and
  // blocks at the gate.
  std::function<std::string(const PluginEnd&)> finish = {};
  // Called before each message of the guard.
  std::function<void()> before_message = {};
};

// Only one guard may exist at a time. The thread that constructs the guard must run the plug-in. The plug-in
// may start other threads.
class PluginGuard {
 public:
  explicit PluginGuard(PluginGuardOptions options);
  // Does not return if the guard is already ending the process.
  ~PluginGuard();
  PluginGuard(const PluginGuard&) = delete;
  PluginGuard& operator=(const PluginGuard&) = delete;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Call thrown_error() in a handler that catches all exceptions. Returns the error for the current exception,
// with `who` as its source. The fault is Fault::failed, or Fault::environment if memory ran out.
Error thrown_error(const std::string& who);

// Like behavior::named_behavior(), but loads a plug-in under a guard. Use guarded_behavior() for names from
// the command line. `label` is the prefix of messages.
Result<behavior::Behavior> guarded_behavior(const std::string& name, const std::string& label);

// The program's replacements of _exit() and _Exit() call before_exit() before ending the process. Does not
// return if a guard ends the process.
void before_exit(const char* function, int status);

}  // namespace kaz::tools
