// The chain of calls as it follows from instructions and the stack pointer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/h8s/chip/observer.h"

namespace kaz::h8s {

struct Frame {
  std::uint32_t function = 0;   // entry address
  std::uint32_t called_at = 0;  // address of the call, or of the interrupted instruction
  std::uint32_t sp = 0;         // ER7 as the function is entered
  bool interrupt = false;
  States begin = 0;  // of the call or of the exception entry
  // For Profile: states spent in interrupts and asleep before `begin`.
  States away = 0;
};

// An observer that knows who called whom. A frame ends as a return leaves ER7 above it, so that
// several end at once where a tail jump or a longjmp left them. A jump to the first instruction of
// another function is a call by the one that jumps; TRAPA is a call; an interrupt begins a frame of
// its own. The first frame is the function at PC as the first instruction is seen.
class CallStack : public Observer {
 public:
  explicit CallStack(const Chip& chip) : chip_(chip) {}

  void before(std::uint32_t pc, States at) override;
  void executed(const Executed& e) override;
  void entered(const ExceptionEntry& e) override;
  void was_reset(ResetCause, States) override;

 protected:
  // The new frame is the last one; the one that ends is the last one still.
  virtual void begun(Frame&) {}
  virtual void ended(const Frame&, States /*at*/) {}
  // The instruction has run and counts for the last frame.
  virtual void spent(const Executed&) {}

  const Chip& chip_;
  std::vector<Frame> frames_;

 private:
  void push(std::uint32_t function, std::uint32_t from, bool interrupt, States begin);
  void leave(States at);
};

}  // namespace kaz::h8s
