// A pseudo-terminal as the serial port of a virtual board.
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

// Non-blocking. The port is raw, 115,200 baud, until the host changes it.
class Pty {
 public:
  // Creates `link_path` as a symbolic link to the port. A stale link to a pty that no longer exists is
  // replaced; with `maker_is_dead`, a link to any pty, as it is known to be left by a killed virtual board.
  // Errors: anything else exists at the path (usage); no pty available.
  static Result<std::unique_ptr<Pty>> open(const std::string& link_path,
                                           bool maker_is_dead = false);
  ~Pty();  // removes the link, if it is still ours

  // Whether some process has the port open.
  bool host_present() const;
  // Speed set by the host, baud; 0 if not one of kSerialRates (shared/base/serial_rates.hpp).
  long baud() const;
  // The same, also of rates that termios has no name for (BOTHER).
  long rate() const;
  // Waits until the host has written something, `length` at most. Without a host, for `length`.
  void wait(Time length, bool host_present) const;
  std::size_t read(std::span<std::uint8_t> bytes);  // bytes of the host; returns their number
  std::size_t write(std::span<const std::uint8_t> bytes);  // returns the number accepted
  // Discards bytes that the host has not read, so that the next host does not receive them. The kernel moves
  // bytes with some delay: call it for a while after a host has closed the port.
  void discard_unread();

  const std::string& port() const { return port_; }  // "/dev/pts/7"
  const std::string& link() const { return link_; }

 private:
  Pty() = default;

  Descriptor master_;
  std::string port_, link_;
};

}  // namespace kaz::sim
