// For tests: simulates a program that is delayed because the processor is busy, in simulated time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/link.h"

namespace kaz::host {

// Forwards all calls. `stalls` is the number of remaining stalls. A stall extends a wait by `length`. A wait
// is extended if it ends at least `pause` after the previous stall.
class StallingLine final : public Link, public Clock {
 public:
  StallingLine(Link& link, Clock& clock) : link_(link), clock_(clock) {}

  Time pause{}, length{};
  int stalls = 0;

  std::string name() const override { return link_.name(); }
  Time byte_time() const override { return link_.byte_time(); }
  Result<void> set_baud(int baud) override { return link_.set_baud(baud); }
  Result<void> write(std::span<const std::uint8_t> bytes) override { return link_.write(bytes); }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    auto count = link_.read(bytes, deadline);
    if (count) KAZ_TRY(stall());
    return count;
  }
  Time now() const override { return clock_.now(); }
  Result<void> sleep_until(Time t) override {
    KAZ_TRY(clock_.sleep_until(t));
    return stall();
  }

 private:
  Result<void> stall() {
    if (stalls == 0 || clock_.now() < ended_ + pause) return {};
    --stalls;
    KAZ_TRY(clock_.sleep_until(clock_.now() + length));
    ended_ = clock_.now();
    return {};
  }

  Link& link_;
  Clock& clock_;
  Time ended_{};
};

}  // namespace kaz::host
