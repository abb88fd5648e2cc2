// Profile: states by function, and in the longest window.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/profile.h"

#include <algorithm>

namespace kaz::h8s {

States Durations::median() const {
  std::int64_t left = (n_ + 1) / 2;
  for (const auto& [states, count] : counts_) {
    left -= count;
    if (left <= 0) return states;
  }
  return 0;
}

Profile::Profile(const Chip& chip, std::optional<ProfileWindow> window)
    : CallStack(chip), window_(window) {}

void Profile::count(std::uint32_t function, std::uint32_t pc, States states) {
  entries_[function].self += states;
  by_address_[std::uint64_t{function} << 32 | pc] += states;
  total_ += states;
}

std::map<std::uint32_t, States> Profile::selves() const {
  std::map<std::uint32_t, States> all;
  for (const auto& [function, entry] : entries_) all[function] = entry.self;
  return all;
}

void Profile::before(std::uint32_t pc, States at) {
  CallStack::before(pc, at);
  if (!window_) return;
  if (inside_ && pc == window_->end) {
    inside_ = false;
    const States took = at - window_begin_ - (asleep_ - window_asleep_);
    if (windows_.count() == 0 || took > windows_.worst()) {
      worst_at_ = window_begin_;
      worst_selves_ = selves();
      for (const auto& [function, self] : selves_before_) worst_selves_[function] -= self;
    }
    windows_.add(took);
  }
  if (pc == window_->begin) {
    inside_ = true;
    window_begin_ = at;
    window_asleep_ = asleep_;
    selves_before_ = selves();
  }
}

void Profile::slept(States from, States to) {
  asleep_ += to - from;
  away_ += to - from;
}

void Profile::begun(Frame& frame) {
  frame.away = away_;
  Entry& entry = entries_[frame.function];
  ++entry.calls;
  ++entry.active;
  entry.interrupt = entry.interrupt || frame.interrupt;
  // The entry into an exception: stacking, vector and first fetch.
  if (frame.interrupt) count(frame.function, frame.function, chip_.now() - frame.begin);
}

void Profile::spent(const Executed& e) {
  count(frames_.back().function, e.pc, e.end - e.begin);
}

void Profile::ended(const Frame& frame, States at) {
  const States took = at - frame.begin - (away_ - frame.away);
  Entry& entry = entries_[frame.function];
  if (--entry.active == 0) entry.with_callees += took;
  entry.durations.add(took);
  if (frame.interrupt) {
    away_ += took;
  } else if (frames_.size() > 1) {
    Edge& edge = edges_[{frames_[frames_.size() - 2].function, frame.called_at, frame.function}];
    ++edge.calls;
    edge.states += took;
  }
}

std::string Profile::name_of(std::uint32_t function) const {
  const Symbol* symbol = chip_.symbols().at(function);
  if (symbol && symbol->address == function) return symbol->name;
  return chip_.symbols().describe(function);
}

std::vector<FunctionProfile> Profile::functions() const {
  std::vector<FunctionProfile> all;
  for (const auto& [function, e] : entries_) {
    FunctionProfile f{function, name_of(function), e.interrupt,         e.calls,
                      e.self,   e.with_callees,    e.durations.worst(), e.durations.median()};
    // Calls that have not returned yet: the outermost one counts up to now.
    for (const Frame& frame : frames_) {
      if (frame.function != function) continue;
      f.with_callees += chip_.now() - frame.begin - (away_ - frame.away);
      break;
    }
    all.push_back(std::move(f));
  }
  std::sort(all.begin(), all.end(), [](const FunctionProfile& a, const FunctionProfile& b) {
    return a.self != b.self ? a.self > b.self : a.address < b.address;
  });
  return all;
}

WorstWindow Profile::worst_window() const {
  WorstWindow w{windows_.count(), windows_.median(), windows_.worst(), worst_at_, {}};
  for (const auto& [function, self] : worst_selves_) {
    if (self == 0) continue;
    FunctionProfile f;
    f.address = function;
    f.name = name_of(function);
    f.self = self;
    w.functions.push_back(std::move(f));
  }
  std::sort(w.functions.begin(), w.functions.end(),
            [](const FunctionProfile& a, const FunctionProfile& b) {
              return a.self != b.self ? a.self > b.self : a.address < b.address;
            });
  return w;
}

}  // namespace kaz::h8s
