// Gate between a plug-in and Kaz: tracks calls from the plug-in into Kaz, and can block further calls.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>

#include "host/behavior/ball_detector.h"
#include "host/behavior/floor_detector.h"
#include "host/link/link.h"

namespace kaz::tools {

// Thread-safe.
class CallGate {
 public:
  // Represents one call from the plug-in into Kaz. Calls are counted and serialized, and may nest. The
  // constructor blocks while the gate is shut. If `gate` is null, as for built-in behaviors, the constructor
  // does nothing.
  class Call {
   public:
    explicit Call(CallGate* gate) : gate_(gate) {
      if (gate_ == nullptr) return;
      gate_->mutex_.lock();
      ++gate_->depth_;
      ++gate_->count_;
    }
    ~Call() {
      if (gate_ == nullptr) return;
      --gate_->depth_;
      gate_->mutex_.unlock();
    }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

   private:
    CallGate* gate_;
  };

  // Shuts the gate. Waits until no call is in progress. From then on, calls from other threads block. Returns
  // false if a call did not end within `at_most`.
  bool shut(std::chrono::milliseconds at_most) { return mutex_.try_lock_for(at_most); }
  // Lets calls pass again. The thread that shut the gate must call open().
  void open() { mutex_.unlock(); }

  // Returns whether a call is in progress.
  bool in_call() const { return depth_ > 0; }
  // Returns the number of calls so far.
  std::uint64_t count() const { return count_; }

 private:
  std::recursive_timed_mutex mutex_;
  std::atomic<int> depth_{0};
  std::atomic<std::uint64_t> count_{0};
};

// Passes all calls on to `link` through a gate, which may be null. `link` and `gate` must outlive this
// object.
class GatedLink final : public host::Link {
 public:
  GatedLink(host::Link& link, CallGate* gate) : link_(link), gate_(gate) {}
  std::string name() const override { return link_.name(); }
  Time byte_time() const override { return link_.byte_time(); }
  Result<void> set_baud(int baud) override {
    const CallGate::Call call(gate_);
    return link_.set_baud(baud);
  }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    const CallGate::Call call(gate_);
    return link_.write(bytes);
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    const CallGate::Call call(gate_);
    return link_.read(bytes, deadline);
  }
  Result<void> reopen() override {
    const CallGate::Call call(gate_);
    return link_.reopen();
  }

 private:
  host::Link& link_;
  CallGate* gate_;
};

// Passes polls on to `detector` through a gate, like GatedLink.
class GatedDetector final : public behavior::BallDetector {
 public:
  GatedDetector(behavior::BallDetector& detector, CallGate* gate)
      : detector_(detector), gate_(gate) {}
  Result<std::vector<vision::BallObservation>> poll(Time now) override {
    const CallGate::Call call(gate_);
    return detector_.poll(now);
  }

 private:
  behavior::BallDetector& detector_;
  CallGate* gate_;
};

// Passes calls on to `detector` through a gate, like GatedLink.
class GatedFloor final : public behavior::FloorDetector {
 public:
  GatedFloor(behavior::FloorDetector& detector, CallGate* gate)
      : detector_(detector), gate_(gate) {}
  Result<std::vector<behavior::FloorPicture>> take() override {
    const CallGate::Call call(gate_);
    return detector_.take();
  }

 private:
  behavior::FloorDetector& detector_;
  CallGate* gate_;
};

}  // namespace kaz::tools
