// Interrupt over an eventfd: one counter, readable from the first request on.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/interrupt.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

namespace kaz::host {

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

Error Interrupt::error() {
  return Error{Fault::failed, "interrupted before it was done"};
}

}  // namespace kaz::host
