// Measures delays of this process at a link, so that the delays are not attributed to a board.
// SPDX-License-Identifier: Apache-2.0
//
// On a busy machine, a process may wait for the processor, and then send requests late and read replies late.
// During such a delay, a board's watchdog may react, or a timeout may expire. LatenessMeter forwards all
// calls and compares the end of each wait with the deadline of the wait. LatenessMeter divides a long wait
// for bytes into slices. The slices show whether the bytes arrived late or read() returned late.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "host/link/link.h"

namespace kaz::host {

class LatenessMeter final : public Link, public Clock {
 public:
  static constexpr Time kSlice = std::chrono::milliseconds(2);
  // Smallest delay that is added to total(). Shorter delays are normal (timer slack, context switches).
  static constexpr Time kNoticed = std::chrono::milliseconds(1);
  // Thresholds of excuse(). A single delay excuses a failure if the delay lasts kExcusing or longer. The sum
  // of all delays excuses a failure if the sum reaches kExcusing, and also exceeds the fraction
  // kExcusingShare of the time since begin().
  static constexpr Time kExcusing = std::chrono::milliseconds(5);
  static constexpr double kExcusingShare = 0.02;
  // Maximum number of repetitions of an operation that failed while this process was delayed. If this process
  // was delayed in every repetition and all repetitions fail, the result is undecided.
  static constexpr int kRepetitions = 3;

  // Returns the total time by which the program at the other end of the link (a simulator) lags behind real
  // time. The program must run on the same machine as this process. If the program is stopped or has ended,
  // it does not reply, and the function fails.
  using TimeLost = std::function<Result<Time>()>;
  // `link` and `clock` must outlive this object. `other_end` may be null.
  LatenessMeter(Link& link, Clock& clock, TimeLost other_end = nullptr);

  // Starts a new measurement and discards all earlier delays.
  void begin();
  // The time from the previous call of a member function to this call does not count as a delay. Call this
  // function after the program has waited for user input.
  void waited() { left_ = clock_.now(); }
  // longest() returns the longest delay since begin(). total() returns the sum of all delays above kNoticed
  // since begin().
  Time longest() const { return longest_; }
  Time total() const { return total_; }
  // Explains why a failure since begin() is inconclusive: "this program was kept waiting for up to 34 ms
  // ...". Returns an empty text if neither this process nor the program at the other end was delayed. Then
  // the failure is the board's fault. The measured operation tolerates delays shorter than `at_least`. So
  // such delays never explain a failure, no matter how many there are.
  std::string excuse(Time at_least = Time::zero()) const;
  // Whether the last excuse() found that the program at the other end does not reply. If the result is true,
  // further repetitions are useless.
  bool other_end_gone() const { return other_end_gone_; }

  // Functions of Link and Clock
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
  std::optional<Time> lost_before_;  // result of other_end_() in begin(); empty: no result
  mutable bool other_end_gone_ = false;
  Time began_, left_, longest_{}, total_{};
};

// Calls `attempt`. If `attempt` fails and meter->excuse(bears) returns an explanation, the attempt is
// repeated, at most kRepetitions times. `bears`: longest delay that an attempt tolerates. If `meter` is null,
// there is only one attempt.
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
