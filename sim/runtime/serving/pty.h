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

// Non-blocking. The port is raw, 115,200 baud, until the host changes it.
class Pty {
 public:
  // Creates `link_path` as a symbolic link to the port. Replaces a link to a pty that no longer exists. With
  // `maker_is_dead`, it replaces a link to any pty, because a killed virtual board has left it. Returns
  // Fault::usage if the path is in use otherwise, and Fault::environment if no pty is available.
  static Result<std::unique_ptr<Pty>> open(const std::string& link_path,
                                           bool maker_is_dead = false);
  ~Pty();  // removes the link if it is still ours

  // Returns whether a process has the port open.
  bool host_present() const;
  // Returns the rate that the host has set, baud; 0 if it is not in kSerialRates
  // (shared/base/serial_rates.hpp).
  long baud() const;
  // Returns the rate that the host has set, also if termios has no name for it (BOTHER).
  long rate() const;
  // Waits until the host has written bytes, at most for `length`. Without a host, waits for `length`. A
  // signal may end the wait.
  void wait(Time length, bool host_present) const;
  std::size_t read(std::span<std::uint8_t> bytes);         // reads host bytes; returns their number
  std::size_t write(std::span<const std::uint8_t> bytes);  // returns the number accepted
  // Discards bytes that the host has not read, so that the next host does not receive them. The kernel moves
  // bytes with some delay, so repeat the call for a while after a host has closed the port.
  void discard_unread();

  const std::string& port() const { return port_; }  // "/dev/pts/7"
  const std::string& link() const { return link_; }

 private:
  Pty() = default;

  Descriptor master_;
  std::string port_, link_;
};

}  // namespace kaz::sim
