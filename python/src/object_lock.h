// One call at a time on an object that Python threads share; a stop ends the call that runs.
// SPDX-License-Identifier: Apache-2.0
//
// Calls run without the GIL, so nothing else keeps a second thread out. A second thread's call is refused. A
// stop is not: it requests the interrupt, waits until the running call has left the object, and then works
// alone. Thread-safe. Does not use Python.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "host/link/interrupt.h"

namespace kaz::python {

class ObjectLock {
 public:
  // `name`: for error messages, as in "this Robot".
  explicit ObjectLock(std::string name) : name_(std::move(name)) {}
  ObjectLock(const ObjectLock&) = delete;
  ObjectLock& operator=(const ObjectLock&) = delete;

  // One call, in one or several pieces of work. Between two pieces its thread may run other Python code, such
  // as a signal handler, whose calls on the same object are nested in this one.
  class Call {
   public:
    enum class State { begun, in_use, stopping };
    explicit Call(ObjectLock& lock);
    ~Call();
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

    // in_use: another thread's call is running. stopping: a stop is. The call must not go on in both cases.
    State state() const { return state_; }
    // Begins a piece, once no stop is at work. False if a stop came since the call began: no piece begins.
    bool enter();
    void leave();

   private:
    ObjectLock& lock_;
    State state_ = State::begun;
    std::thread::id outer_;
    std::uint64_t stops_ = 0;
  };

  // While it lives its thread alone works on the object; the constructor waits for that. It ends all calls
  // that began before it: they begin no further piece, and other calls may begin afterwards.
  class Stop {
   public:
    explicit Stop(ObjectLock& lock);
    ~Stop();
    Stop(const Stop&) = delete;
    Stop& operator=(const Stop&) = delete;

   private:
    ObjectLock& lock_;
  };

  const std::string& name() const { return name_; }
  // For the object's links and clocks: requested while a stop waits for a piece of work.
  host::Interrupt& interrupt() { return interrupt_; }

 private:
  const std::string name_;
  host::Interrupt interrupt_;
  std::mutex mutex_;
  std::condition_variable left_;
  std::thread::id owner_;  // of the running call
  bool inside_ = false;    // a piece or a stop is at work
  bool stopping_ = false;  // a stop is
  int waiting_ = 0;        // stops that are not at work yet
  std::uint64_t stops_ = 0;
};

}  // namespace kaz::python
