// Profile: states by function, and in the longest window (such as a tick).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "sim/h8s/debug/call_stack.h"

namespace kaz::h8s {

// Distribution of durations, in states.
class Durations {
 public:
  void add(States s) {
    ++counts_[s];
    ++n_;
  }
  std::int64_t count() const { return n_; }
  States worst() const { return counts_.empty() ? 0 : counts_.rbegin()->first; }
  // Of an even number the lower of the two middle values.
  States median() const;

 private:
  std::map<States, std::int64_t> counts_;
  std::int64_t n_ = 0;
};

struct FunctionProfile {
  std::uint32_t address = 0;
  std::string name;
  bool interrupt = false;
  std::int64_t calls = 0;
  States self = 0;               // in the function's own instructions; interrupts: with the entry
  States with_callees = 0;       // of recursive functions the outermost calls only
  States worst = 0, median = 0;  // of one call, with callees, of those that have returned
};

// A repeated section of the program, from the instruction at `begin` to that at `end`.
struct ProfileWindow {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

// The longest window: its states (without sleep, with interrupts), and those of each function.
struct WorstWindow {
  std::int64_t windows = 0;
  States median = 0, worst = 0, at = 0;
  std::vector<FunctionProfile> functions;  // name, address, self only
};

// Attach it to the chip. States asleep are not attributed to any function; those of an interrupt, including
// its 8 states of entry, to its handler; those of a call instruction to the caller, those of RTS to the
// callee.
class Profile final : public CallStack {
 public:
  explicit Profile(const Chip& chip, std::optional<ProfileWindow> window = {});

  // In descending order of `self`.
  std::vector<FunctionProfile> functions() const;
  WorstWindow worst_window() const;
  States asleep() const { return asleep_; }
  States total() const { return total_; }

  std::string text() const;
  std::string json() const;
  // For KCachegrind and callgrind_annotate; lines where the image has them.
  std::string callgrind() const;

  void before(std::uint32_t pc, States at) override;
  void slept(States from, States to) override;

 private:
  void begun(Frame& frame) override;
  void ended(const Frame& frame, States at) override;
  void spent(const Executed& e) override;
  void count(std::uint32_t function, std::uint32_t pc, States states);

  struct Entry {
    States self = 0, with_callees = 0;
    std::int64_t calls = 0;
    int active = 0;
    bool interrupt = false;
    Durations durations;
  };
  struct Edge {
    std::int64_t calls = 0;
    States states = 0;
  };
  using EdgeKey = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // caller, pc, callee

  std::string name_of(std::uint32_t function) const;
  std::map<std::uint32_t, States> selves() const;

  std::unordered_map<std::uint32_t, Entry> entries_;
  std::unordered_map<std::uint64_t, States> by_address_;  // function << 32 | pc
  std::map<EdgeKey, Edge> edges_;
  States away_ = 0;  // in interrupts that have ended, and asleep
  States asleep_ = 0, total_ = 0;

  std::optional<ProfileWindow> window_;
  bool inside_ = false;
  States window_begin_ = 0, window_asleep_ = 0, worst_at_ = 0;
  std::map<std::uint32_t, States> selves_before_, worst_selves_;
  Durations windows_;
};

}  // namespace kaz::h8s
