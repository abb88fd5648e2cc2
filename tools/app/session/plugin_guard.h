// Runs code of a plug-in such that this program ends in order, whatever that code does.
// SPDX-License-Identifier: Apache-2.0
//
// A plug-in is foreign code in this process. An exception that it throws is handled as an error
// (thrown_error()). But it may also crash, call exit(), _exit() or abort(), or never return. It may throw
// outside of any handler, as in its own thread or in a static initializer. In all these cases the guard parks
// the thread, and the guard's own thread does the necessary work before the process ends.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/behavior/plugin.h"
#include "host/link/interrupt.h"
#include "shared/base/result.hpp"
#include "tools/app/session/call_gate.h"

namespace kaz::tools {

// How a plug-in ended the process, or why it was ended.
struct PluginEnd {
  // Fault::interrupted if it did not return after an interrupt.
  Error error;
  // Cause: "SIGSEGV", "exit(3)", or the name of the received signal.
  std::string by;
};

struct PluginGuardOptions {
  std::string label;          // prefix of messages: "kaz run"
  std::string path;           // path of the plug-in
  std::string doing = "run";  // for messages: "run" or "loaded"
  // Fault, and thus exit status, if the plug-in calls exit() or throws outside of any handler.
  Fault fault = Fault::failed;
  CallGate* gate = nullptr;
  host::Interrupt* interrupt = nullptr;
  // Called last before the process ends, except for the message; returns text to append to it. It runs on the
  // guard's thread. The plug-in's thread is parked, or runs in its own code and blocks at the gate.
  std::function<std::string(const PluginEnd&)> finish = {};
  // Called before each message of the guard.
  std::function<void()> before_message = {};
};

// Only one guard may exist at a time. The thread that constructs it runs the plug-in, which may start others.
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

// Call this in a handler of all exceptions. Returns the error for the current exception, with `who` as its
// source. The fault is Fault::failed, or environment if memory ran out.
Error thrown_error(const std::string& who);

// Like behavior::named_behavior(), for a name from the command line: loads a plug-in under a guard. `label`
// is the prefix of messages.
Result<behavior::Behavior> guarded_behavior(const std::string& name, const std::string& label);

// The program's own _exit() and _Exit() call this before they end the process. Does not return if a guard
// ends it.
void before_exit(const char* function, int status);

}  // namespace kaz::tools
