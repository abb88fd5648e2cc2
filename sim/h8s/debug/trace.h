// Instruction trace: a line of text for each instruction, with time, address, disassembly and effects.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <ostream>
#include <string>

#include "sim/h8s/chip/observer.h"

namespace kaz::h8s {

// Observer that writes one line for each instruction, for example:
//
//   "     1234  001006  _main+0x6  mov.w r0,@0xffe100:16  ccr=80  [ffe100]=0005"
//
// The columns are start time in states, address, symbol, instruction, changed registers and bus accesses ("="
// for writes, "->" for reads). Interrupts, sleep and resets have their own lines. `chip` must outlive this
// object.
class Trace final : public Observer {
 public:
  // Writes each line to `out`, which must outlive this object.
  Trace(const Chip& chip, std::ostream& out);
  // Keeps the last `lines` lines, which text() returns.
  Trace(const Chip& chip, std::size_t lines);

  std::string text() const;

  void before(std::uint32_t pc, States at) override;
  void executed(const Executed& e) override;
  void accessed(const Access& access) override;
  void entered(const ExceptionEntry& e) override;
  void slept(States from, States to) override;
  void was_reset(ResetCause cause, States at) override;

 private:
  void line(std::string text);

  const Chip& chip_;
  std::ostream* out_ = nullptr;
  std::size_t kept_ = 0;
  std::deque<std::string> lines_;
  Registers before_;
  std::string text_, accesses_;
};

}  // namespace kaz::h8s
