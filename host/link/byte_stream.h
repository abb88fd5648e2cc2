// Non-blocking reads and writes on a descriptor, waiting in poll(): what serial ports and TCP share.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/link/interrupt.h"
#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"
#include "vision/image/frame.h"  // Time

namespace kaz::host {

class ByteStream {
 public:
  // `name` and `closed` are for messages: "/dev/ttyUSB0", and the sentence for a descriptor whose other
  // end is gone. `interrupt` may be null; else it must outlive the stream, and makes `read` fail once
  // requested.
  ByteStream(std::string name, std::string closed, const Interrupt* interrupt)
      : name_(std::move(name)), closed_(std::move(closed)), interrupt_(interrupt) {}

  // Takes a non-blocking descriptor in place of the one before, whose unsent bytes are dropped.
  void attach(Descriptor fd);
  void detach() { attach(Descriptor()); }
  int descriptor() const { return descriptor_.get(); }
  bool has_unsent() const { return !pending_.empty(); }
  void drop_unsent() { pending_.clear(); }
  bool is_open() const { return static_cast<bool>(descriptor_); }
  Error closed() const { return Error{Fault::environment, closed_}; }

  // Fails when the other end is gone, and from then on; or when it has taken no byte of the last 64 KB.
  // Bytes that the other end of a socket sent before it closed can still be read.
  Result<void> write(std::span<const std::uint8_t> bytes);
  // As Link::read.
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline);

 private:
  Result<void> flush();

  std::string name_, closed_;
  const Interrupt* interrupt_;
  Descriptor descriptor_;
  bool socket_ = false;
  std::vector<std::uint8_t> pending_;  // what the descriptor has not taken yet
};

// Waits until `descriptor` has `events` (POLLIN, POLLOUT), an error or a hang-up, or the deadline has come;
// returns what it has, 0 at the deadline. Fails if interrupted. For `name` see above.
Result<short> wait_for(int descriptor, short events, Time deadline, const Interrupt* interrupt,
                       const std::string& name);

}  // namespace kaz::host
