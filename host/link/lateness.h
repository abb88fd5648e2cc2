// Measures how late this program was at a link, lest its own lateness be blamed on a board.
// SPDX-License-Identifier: Apache-2.0
//
// A busy machine lets a program wait for the processor. Its requests then leave late and replies
// are read late; a board's watchdog may have reacted meanwhile, or a time-out ended. LatenessMeter
// passes all calls on, and compares when each wait had to end with when it did. Waits for bytes are
// cut into slices, because otherwise a late return with bytes would look like bytes that came late.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "host/link/link.h"

namespace kaz::host {

class LatenessMeter final : public Link, public Clock {
 public:
  static constexpr Time kSlice = std::chrono::milliseconds(2);
  // Shorter ones are ordinary: a timer's slack, a context switch.
  static constexpr Time kNoticed = std::chrono::milliseconds(1);
  // What excuses a failure: one so long; or all together so long and above this share of the time
  // since begin().
  static constexpr Time kExcusing = std::chrono::milliseconds(5);
  static constexpr double kExcusingShare = 0.02;
  // How often something that failed late is tried anew before it is given up as undecided.
  static constexpr int kRepetitions = 3;

  // Time by which the program at the other end, if it is one of this machine, fell behind so far. Error: it
  // does not reply, as it is stopped or has ended.
  using TimeLost = std::function<Result<Time>()>;
  // Link and clock must outlive it.
  LatenessMeter(Link& link, Clock& clock, TimeLost other_end = nullptr);

  // Begins anew: what was late until now does not count.
  void begin();
  // The program has waited for somebody at the keyboard: the time since its last call is no lateness.
  void waited() { left_ = clock_.now(); }
  // Lateness since begin(): the longest, and the sum of those above kNoticed.
  Time longest() const { return longest_; }
  Time total() const { return total_; }
  // Why a failure since begin() proves nothing, as "this program was kept waiting for up to 34 ms,
  // ..."; empty if it was punctual: then the failure is the board's. `at_least`: what is judged bears
  // any number of shorter ones.
  std::string excuse(Time at_least = Time::zero()) const;
  // Whether the last excuse() was that the program at the other end does not reply: nothing more can be
  // decided.
  bool other_end_gone() const { return other_end_gone_; }

  // Link and Clock
  std::string name() const override { return link_.name(); }
  Time byte_time() const override { return link_.byte_time(); }
  Result<void> set_baud(int baud) override { return link_.set_baud(baud); }
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override;
  Result<void> reopen() override { return link_.reopen(); }
  Time now() const override { return clock_.now(); }
  Result<void> sleep_until(Time t) override;

 private:
  Time enter();
  void leave(Time due);
  void add(Time late);
  Link& link_;
  Clock& clock_;
  TimeLost other_end_;
  std::optional<Time> lost_before_;  // none: it did not reply
  mutable bool other_end_gone_ = false;
  Time began_, left_, longest_{}, total_{};
};

// Calls `attempt` up to kRepetitions times more while its result is an error and the machine was late, by
// more than the attempt bears. `meter` may be null.
template <class Attempt>
auto repeat_if_late(LatenessMeter* meter, Attempt attempt, Time bears = Time::zero()) {
  for (int again = LatenessMeter::kRepetitions;; --again) {
    if (meter) meter->begin();
    auto result = attempt();
    if (result || result.error().fault == Fault::interrupted || again == 0 || !meter ||
        meter->excuse(bears).empty() || meter->other_end_gone())
      return result;
  }
}

}  // namespace kaz::host
