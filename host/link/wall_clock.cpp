// Waiting on CLOCK_MONOTONIC, cut short by an interrupt.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/wall_clock.h"

#include <poll.h>
#include <time.h>

#include <cerrno>
#include <cstring>

namespace kaz::host {

namespace {

timespec to_timespec(Time t) {
  const auto ns = t.count();
  return {static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
}

}  // namespace

Time WallClock::now() const {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return Time(std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec);
}

Result<void> WallClock::sleep_until(Time t) {
  while (true) {
    if (interrupt_ && interrupt_->ends_waiting()) return tl::unexpected(Interrupt::error());
    const Time left = t - now();
    if (left <= Time::zero()) return {};
    const timespec wait = to_timespec(interrupt_ ? interrupt_->max_wait(left) : left);
    pollfd watched{interrupt_ ? interrupt_->descriptor() : -1, POLLIN, 0};
    if (ppoll(&watched, 1, &wait, nullptr) < 0 && errno != EINTR) {
      return fail(Fault::environment,
                  std::string("cannot wait until a given time: ") + std::strerror(errno));
    }
  }
}

}  // namespace kaz::host
