// The call stack, derived from instructions and the stack pointer.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/call_stack.h"

namespace kaz::h8s {
namespace {

// Limit of the depth, for programs that call without ever returning.
constexpr std::size_t kMaxDepth = 4096;

}  // namespace

void CallStack::push(std::uint32_t function, std::uint32_t from, bool interrupt, States begin) {
  if (frames_.size() >= kMaxDepth) frames_.erase(frames_.begin() + 1);
  Frame frame;
  frame.function = function;
  frame.called_at = from;
  frame.sp = chip_.registers().er[7];
  frame.interrupt = interrupt;
  frame.begin = begin;
  frames_.push_back(frame);
  begun(frames_.back());
}

void CallStack::before(std::uint32_t pc, States at) {
  if (!frames_.empty()) return;
  const Symbol* symbol = chip_.symbols().at(pc);
  push(symbol ? symbol->address : pc, pc, false, at);
  frames_.back().sp = 0xffffffff;
}

void CallStack::executed(const Executed& e) {
  spent(e);
  switch (e.flow) {
    case Flow::call:
    case Flow::trap:
      push(e.next, e.pc, false, e.end);
      break;
    case Flow::back:
    case Flow::exit:
      leave(e.end);
      break;
    case Flow::jump: {
      const Symbol* symbol = chip_.symbols().at(e.next);
      if (!symbol || symbol->address != e.next || !symbol->function) break;
      if (frames_.back().function == e.next) break;
      const std::uint32_t sp = frames_.back().sp;
      push(e.next, e.pc, false, e.end);
      frames_.back().sp = sp;
      break;
    }
    default:
      break;
  }
}

void CallStack::entered(const ExceptionEntry& e) {
  push(e.handler, e.interrupted, true, e.begin);
}

void CallStack::leave(States at) {
  const std::uint32_t sp = chip_.registers().er[7];
  while (frames_.size() > 1 && frames_.back().sp < sp) {
    ended(frames_.back(), at);
    frames_.pop_back();
  }
}

void CallStack::was_reset(ResetCause, States at) {
  while (!frames_.empty()) {
    ended(frames_.back(), at);
    frames_.pop_back();
  }
}

}  // namespace kaz::h8s
