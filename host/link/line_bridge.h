// Forwards bytes in both directions between a board's line and a bus or network.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "host/link/port_link.h"

namespace kaz::host {

class LineBridge {
 public:
  // Receives one line for the user, without newline: a side was lost or is available again.
  using Report = std::function<void(const std::string&)>;

  // Both links and `interrupt` must outlive it.
  LineBridge(PortLink& board, PortLink& far, const Interrupt& interrupt, Report report);

  // Runs until interrupted. Reopens a lost side every 50 ms and drops bytes for it meanwhile. Link failures
  // do not end it, except those with Fault::usage, which it returns.
  Result<void> run();

  // "12345 bytes to the board, 23456 back, 12 dropped"
  std::string counts() const;

 private:
  struct Side {
    PortLink& link;
    bool there = true;
    Time lost{}, next_try{};
    std::uint64_t taken = 0, dropped = 0;  // bytes for this side
  };
  Result<void> wait();
  Result<void> carry(Side& from, Side& to);
  Result<void> lose(Side& side, const Error& error);
  Result<void> seek(Side& side);

  Side board_, far_;
  const Interrupt& interrupt_;
  Report report_;
};

}  // namespace kaz::host
