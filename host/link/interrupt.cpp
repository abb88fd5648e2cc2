// Interrupt over an eventfd: one counter, readable from the first request on.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/interrupt.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace kaz::host {
namespace {

std::int64_t steady_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Interrupt::Interrupt() : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Interrupt::~Interrupt() {
  close(descriptor_);
}

void Interrupt::request() noexcept {
  const int saved_errno = errno;
  requested_.store(true, std::memory_order_release);
  const std::uint64_t one = 1;
  // The write can only fail when the counter is full, and then the descriptor is readable already.
  [[maybe_unused]] const ssize_t written = write(descriptor_, &one, sizeof one);
  errno = saved_errno;
}

void Interrupt::withdraw() noexcept {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t taken = read(descriptor_, &count, sizeof count);
  requested_.store(false, std::memory_order_release);
}

bool Interrupt::cleaning() const noexcept {
  const std::int64_t until = clean_until_ns_.load(std::memory_order_acquire);
  return until != 0 && steady_ns() < until;
}

bool Interrupt::ends_waiting() const noexcept {
  return requested() && !cleaning();
}

int Interrupt::descriptor() const noexcept {
  return cleaning() ? -1 : descriptor_;
}

Time Interrupt::max_wait(Time left) const noexcept {
  const std::int64_t until = clean_until_ns_.load(std::memory_order_acquire);
  if (until == 0) return left;
  // The descriptor is not polled: a request after the end of the clean-up must not wait either.
  return std::min(left, std::max(Time(until - steady_ns()), Time(1'000'000)));
}

Error Interrupt::error() {
  return Error{Fault::interrupted, "interrupted"};
}

CleanUp::CleanUp(Interrupt& interrupt, std::chrono::milliseconds longest) : interrupt_(interrupt) {
  interrupt_.clean_until_ns_ = steady_ns() + std::chrono::nanoseconds(longest).count();
}

CleanUp::~CleanUp() {
  interrupt_.clean_until_ns_ = 0;
}

}  // namespace kaz::host
