// Observers that measure the stack depth and report reads of uninitialized RAM.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <string>
#include <unordered_set>
#include <vector>

#include "sim/h8s/debug/call_stack.h"

namespace kaz::h8s {

// Records the lowest value of ER7 since this observer was attached, and the call stack at the time of that
// value.
class StackMeter final : public CallStack {
 public:
  explicit StackMeter(const Chip& chip) : CallStack(chip) {}

  std::uint32_t lowest() const { return lowest_; }
  // Returns the number of bytes between the highest and the lowest observed ER7. If the program sets its
  // stack pointer only once, this number is the stack usage.
  std::uint32_t used() const { return highest_ < lowest_ ? 0 : highest_ - lowest_; }
  // Returns the call stack at the lowest ER7, outermost frame first, including interrupts.
  const std::vector<Frame>& chain() const { return chain_; }
  // Returns the time of the lowest ER7.
  States at() const { return at_; }
  std::string text() const;

 private:
  void begun(Frame&) override { look(chip_.now()); }
  void spent(const Executed& e) override { look(e.end); }
  void look(States at);

  std::uint32_t lowest_ = 0xffffffff, highest_ = 0;
  std::vector<Frame> chain_;
  States at_ = 0;
};

struct UninitialisedRead {
  std::uint32_t address = 0;
  std::uint32_t pc = 0;
  States at = 0;
};

// Reports reads of uninitialized RAM, once for each instruction. At power-on and when this object is
// constructed, all bytes count as uninitialized. A write by the program or by Chip::poke initializes a byte.
// After Chip::restore all bytes count as initialized.
class UninitialisedReads final : public Observer {
 public:
  explicit UninitialisedReads(const Chip& chip) : chip_(chip) {}

  const std::vector<UninitialisedRead>& reads() const { return reads_; }
  std::string text() const;

  void accessed(const Access& access) override;
  void was_reset(ResetCause cause, States at) override;
  void changed(std::uint32_t address, std::uint32_t size) override;

 private:
  // Returns the index of an address in written_: the low 13 bits of the address. All RAM is in the top 8 KiB.
  static std::size_t place(std::uint32_t address) { return address & 0x1fff; }

  const Chip& chip_;
  std::bitset<0x2000> written_;
  std::unordered_set<std::uint32_t> reported_;
  std::vector<UninitialisedRead> reads_;
};

}  // namespace kaz::h8s
