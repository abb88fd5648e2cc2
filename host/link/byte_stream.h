// Non-blocking reads and writes on a descriptor, shared by serial ports and TCP links.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/link/interrupt.h"
#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"
#include "shared/base/time.hpp"

namespace kaz::host {

class ByteStream {
 public:
  // `name` ("/dev/ttyUSB0") and `closed` appear in error messages. `closed` is the error message if the other
  // end has closed the stream. `interrupt` may be null. If `interrupt` is not null, it must outlive the
  // stream, and an interrupt request makes `read` fail.
  ByteStream(std::string name, std::string closed, const Interrupt* interrupt)
      : name_(std::move(name)), closed_(std::move(closed)), interrupt_(interrupt) {}

  // Takes ownership of a non-blocking descriptor and closes the previous one. Drops unsent bytes.
  void attach(Descriptor fd);
  void detach() { attach(Descriptor()); }
  int descriptor() const { return descriptor_.get(); }
  bool has_unsent() const { return !pending_.empty(); }
  void drop_unsent() { pending_.clear(); }
  bool is_open() const { return static_cast<bool>(descriptor_); }
  Error closed() const { return Error{Fault::environment, closed_}; }

  // Queues `bytes` and writes as many of the queued bytes as the descriptor accepts. Fails if the other end
  // is closed. Also fails if the unsent bytes and `bytes` together exceed 64 KiB. After a failed write to a
  // socket, read() still returns the bytes that the socket had received before.
  Result<void> write(std::span<const std::uint8_t> bytes);
  // Like Link::read, but also sends queued bytes during the wait.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline);

 private:
  Result<void> flush();

  std::string name_, closed_;
  const Interrupt* interrupt_;
  Descriptor descriptor_;
  bool socket_ = false;
  std::vector<std::uint8_t> pending_;  // bytes that the descriptor has not accepted yet
};

// Waits until `descriptor` has one of `events` (POLLIN, POLLOUT), an error or a hang-up, or until `deadline`.
// Returns the poll() events, or 0 at the deadline. Fails if interrupted. `name` appears in error messages.
Result<short> wait_for(int descriptor, short events, Time deadline, const Interrupt* interrupt,
                       const std::string& name);

}  // namespace kaz::host
