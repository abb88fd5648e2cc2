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
  // Callback that gets one line for the user, without newline, when a side is lost or available again.
  using Report = std::function<void(const std::string&)>;

  // Both links and `interrupt` must outlive the bridge.
  LineBridge(PortLink& board, PortLink& far, const Interrupt& interrupt, Report report);

  // Runs until interrupted. Tries to reopen a lost side every 50 ms and drops all bytes for this side in the
  // meantime. If a link fails with Fault::usage, run() returns this failure. Other link failures do not end
  // the bridge.
  Result<void> run();

  // Returns a text such as "12345 bytes to the board, 23456 back, 12 dropped".
  std::string counts() const;

 private:
  struct Side {
    PortLink& link;
    bool there = true;
    Time lost{}, next_try{};
    std::uint64_t taken = 0, dropped = 0;  // counts of bytes for this side
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
