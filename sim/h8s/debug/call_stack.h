// The call stack, derived from instructions and the stack pointer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/h8s/chip/observer.h"

namespace kaz::h8s {

struct Frame {
  std::uint32_t function = 0;   // entry address
  std::uint32_t called_at = 0;  // address of the call, or of the interrupted instruction
  std::uint32_t sp = 0;         // ER7 at entry to the function
  bool interrupt = false;
  States begin = 0;  // of the call or of the exception entry
  // For Profile: states spent in interrupts and asleep before `begin`.
  States away = 0;
};

// Observer that tracks the call stack. A frame ends when a return leaves ER7 above it, so several end at
// once after a tail jump or longjmp. A jump to the first instruction of another function counts as a call
// by the function that jumps; TRAPA counts as a call; an interrupt begins a frame of its own. The first
// frame is the function at PC when the first instruction is observed.
class CallStack : public Observer {
 public:
  explicit CallStack(const Chip& chip) : chip_(chip) {}

  void before(std::uint32_t pc, States at) override;
  void executed(const Executed& e) override;
  void entered(const ExceptionEntry& e) override;
  void was_reset(ResetCause, States) override;

 protected:
  // The frame that begins or ends is the last one in frames_ during the call.
  virtual void begun(Frame&) {}
  virtual void ended(const Frame&, States /*at*/) {}
  // An instruction of the last frame has run.
  virtual void spent(const Executed&) {}

  const Chip& chip_;
  std::vector<Frame> frames_;

 private:
  void push(std::uint32_t function, std::uint32_t from, bool interrupt, States begin);
  void leave(States at);
};

}  // namespace kaz::h8s
