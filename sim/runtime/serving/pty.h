// Pseudo-terminal that serves as the serial port of a virtual board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "shared/base/descriptor.hpp"
#include "shared/base/result.hpp"
#include "shared/base/time.hpp"

namespace kaz::sim {

// All transfers are non-blocking. Initially, the port is in raw mode at 115,200 baud. The host may change
// these settings of the port.
class Pty {
 public:
  // Creates `link_path` as a symbolic link to the port. An existing link is replaced if the link's pty no
  // longer exists. If `maker_is_dead` is true, an existing link to any pty is also replaced. Set
  // `maker_is_dead` only if the virtual board that created the link was killed. If any other link or file
  // exists at the path, returns Fault::usage. Returns Fault::environment if no pty is available.
  static Result<std::unique_ptr<Pty>> open(const std::string& link_path,
                                           bool maker_is_dead = false);
  ~Pty();  // removes the link unless another process has replaced the link

  // Returns whether a process has the port open.
  bool host_present() const;
  // Returns the bit rate that the host has set, in baud. Returns 0 if this rate is not in kSerialRates
  // (shared/base/serial_rates.hpp).
  long baud() const;
  // Returns the bit rate that the host has set, in baud. Unlike baud(), also returns nonstandard rates, which
  // a host sets with the termios2 flag BOTHER.
  long rate() const;
  // Waits until the host has written bytes, but not longer than `length`. If no host is present, the wait
  // lasts `length`. A signal may end the wait early.
  void wait(Time length, bool host_present) const;
  // Reads bytes from the host. Returns the number of bytes read.
  std::size_t read(std::span<std::uint8_t> bytes);
  // Writes bytes to the host. Returns the number of bytes accepted.
  std::size_t write(std::span<const std::uint8_t> bytes);
  // Discards bytes that the host has not read, so that the next host does not receive these bytes. The kernel
  // moves bytes with some delay. Therefore repeat the call for some time after a host has closed the port.
  void discard_unread();

  const std::string& port() const { return port_; }  // such as "/dev/pts/7"
  const std::string& link() const { return link_; }

 private:
  Pty() = default;

  Descriptor master_;
  std::string port_, link_;
};

}  // namespace kaz::sim
