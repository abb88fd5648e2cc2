// Profiler: counts the states of each function, in total and in the longest window (such as a tick).
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
  // Returns the lower of the two middle values if count() is even.
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
  // States in the function's own instructions. For an interrupt handler, also the states of the exception
  // entry.
  States self = 0;
  // States in the function and its callees. For recursive calls, only the outermost call counts.
  States with_callees = 0;
  States worst = 0, median = 0;  // durations of completed calls, with callees
};

// A section of the program that runs repeatedly. The section begins just before the instruction at `begin`
// runs and ends just before the instruction at `end` runs.
struct ProfileWindow {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

// Statistics of the windows. `functions` contains the states of each function in the longest window. States
// in interrupts are included. States in which the CPU sleeps are not included.
struct WorstWindow {
  std::int64_t windows = 0;
  // `median` and `worst` are durations of windows. `at` is the start time of the longest window.
  States median = 0, worst = 0, at = 0;
  // Only `name`, `address` and `self` of each function are set.
  std::vector<FunctionProfile> functions;
};

// Attach this observer to the chip (Chip::attach). The chip must outlive the observer. States in which the
// CPU sleeps belong to no function. The states of an interrupt, including the exception entry, belong to the
// interrupt handler. The states of a call instruction belong to the caller. The states of RTS belong to the
// callee.
class Profile final : public CallStack {
 public:
  explicit Profile(const Chip& chip, std::optional<ProfileWindow> window = {});

  // Returns the functions in descending order of `self`.
  std::vector<FunctionProfile> functions() const;
  WorstWindow worst_window() const;
  States asleep() const { return asleep_; }
  States total() const { return total_; }

  std::string text() const;
  std::string json() const;
  // Returns the profile for KCachegrind and callgrind_annotate, with line numbers if the image contains line
  // numbers.
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
  std::unordered_map<std::uint64_t, States> by_address_;  // key: function << 32 | pc
  std::map<EdgeKey, Edge> edges_;
  States away_ = 0;  // states spent in completed interrupts or asleep
  States asleep_ = 0, total_ = 0;

  std::optional<ProfileWindow> window_;
  bool inside_ = false;
  States window_begin_ = 0, window_asleep_ = 0, worst_at_ = 0;
  std::map<std::uint32_t, States> selves_before_, worst_selves_;
  Durations windows_;
};

}  // namespace kaz::h8s
