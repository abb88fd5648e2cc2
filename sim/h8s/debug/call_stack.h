// Tracks the call stack of a running chip from its instructions and stack pointer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/h8s/chip/observer.h"

namespace kaz::h8s {

// One call of a function or interrupt handler.
struct Frame {
  std::uint32_t function = 0;   // entry address
  std::uint32_t called_at = 0;  // address of the call, or of the interrupted instruction
  std::uint32_t sp = 0;         // ER7 at entry to the function
  bool interrupt = false;
  States begin = 0;  // time of the call or of the exception entry
  // Used only by the class Profile. Counts states before the time `begin`: the states in which the chip
  // slept, plus the states of all interrupts that ended before `begin`.
  States away = 0;
};

// Observer that tracks the call stack. A return instruction ends all frames whose `sp` is below the new ER7.
// After a tail jump or longjmp, one return instruction can therefore end several frames. A jump to the first
// instruction of another function counts as a call by the function that jumps. TRAPA counts as a call. An
// interrupt begins its own frame. The first frame belongs to the function that contains the first observed
// instruction. If the depth would exceed 4,096, the second-outermost frame is dropped. `chip` must outlive
// this object.
class CallStack : public Observer {
 public:
  explicit CallStack(const Chip& chip) : chip_(chip) {}

  void before(std::uint32_t pc, States at) override;
  void executed(const Executed& e) override;
  void entered(const ExceptionEntry& e) override;
  void was_reset(ResetCause, States) override;

 protected:
  // Called when a frame begins or ends. During this notification the frame is the last element of frames_.
  virtual void begun(Frame&) {}
  virtual void ended(const Frame&, States /*at*/) {}
  // Called after each executed instruction. The instruction belongs to the innermost frame, `frames_.back()`.
  virtual void spent(const Executed&) {}

  const Chip& chip_;
  std::vector<Frame> frames_;

 private:
  void push(std::uint32_t function, std::uint32_t from, bool interrupt, States begin);
  void leave(States at);
};

}  // namespace kaz::h8s
