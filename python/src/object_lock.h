// Rejects concurrent calls on an object that Python threads share. A stop ends the running call.
// SPDX-License-Identifier: Apache-2.0
//
// Calls run without the GIL, so only this lock keeps a second thread out. While a call is running, calls of
// other threads are refused, but a stop is accepted. The stop requests the interrupt, waits until the running
// call has left the object, and is then the only user of the object. Thread-safe. Does not use Python.
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
  // `name` is the object's name in error messages, for example "this Robot".
  explicit ObjectLock(std::string name) : name_(std::move(name)) {}
  ObjectLock(const ObjectLock&) = delete;
  ObjectLock& operator=(const ObjectLock&) = delete;

  // One call on the object. A call consists of one or several pieces of work. Between two pieces, the calling
  // thread may run other Python code, such as a signal handler. If that code calls the same object, the new
  // call is nested in the running call.
  class Call {
   public:
    enum class State { begun, in_use, stopping };
    explicit Call(ObjectLock& lock);
    ~Call();
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

    // in_use: another thread's call is running. stopping: a stop is running. If the state is in_use or
    // stopping, the call must not go on.
    State state() const { return state_; }
    // Begins a piece of work, after waiting for a running stop. If a stop has run since the call began,
    // returns false without beginning a piece.
    bool enter();
    void leave();

   private:
    ObjectLock& lock_;
    State state_ = State::begun;
    std::thread::id outer_;
    std::uint64_t stops_ = 0;
  };

  // While a Stop exists, only the thread of the Stop works on the object. The constructor waits until the
  // running piece of work has ended. Calls that began before the Stop begin no further piece of work. New
  // calls may begin after the Stop.
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
  // Interrupt for the object's links and clocks. The interrupt is requested while a stop waits for a piece
  // of work to end.
  host::Interrupt& interrupt() { return interrupt_; }

 private:
  const std::string name_;
  host::Interrupt interrupt_;
  std::mutex mutex_;
  std::condition_variable left_;
  std::thread::id owner_;  // thread of the running call
  bool inside_ = false;    // true while a piece of work or a stop runs
  bool stopping_ = false;  // true while a stop runs
  int waiting_ = 0;        // number of stops that wait
  std::uint64_t stops_ = 0;
};

}  // namespace kaz::python
