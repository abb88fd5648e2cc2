// A pseudo-terminal that stands for the serial port of a virtual board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "shared/base/result.hpp"
#include "sim/runtime/serving/descriptor.h"

namespace kaz::sim {

// Never waits. The port is raw, 115,200 baud, until the host sets it otherwise.
class Pty {
 public:
  // `link_path` becomes a symbolic link to the port. A link of ours to a pty that is gone is replaced;
  // `maker_is_dead`: a link to any pty, because it is known to be of a virtual board that was killed.
  // Errors: anything else stands there (usage), no pty can be had.
  static Result<std::unique_ptr<Pty>> open(const std::string& link_path,
                                           bool maker_is_dead = false);
  ~Pty();  // removes the link, if it is still ours

  // Whether some process has the port open.
  bool host_present() const;
  // Speed that the host has set, baud; 0 if it is none of the standard ones.
  long baud() const;
  std::size_t read(std::span<std::uint8_t> bytes);         // what the host wrote
  std::size_t write(std::span<const std::uint8_t> bytes);  // how many it can take
  // Throws away what we wrote and the host has not read, so that the next host does not hear it.
  // The kernel moves bytes from side to side with some delay: call it for a while after a host has
  // gone.
  void discard_unread();

  const std::string& port() const { return port_; }  // "/dev/pts/7"
  const std::string& link() const { return link_; }

 private:
  Pty() = default;

  Descriptor master_;
  std::string port_, link_;
};

}  // namespace kaz::sim
