// Joins a board's line with a bus or a network: bytes of one link leave on the other, both ways.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "host/link/port_link.h"

namespace kaz::host {

class LineBridge {
 public:
  // One line for the user: a side was lost, and is there again. Without newline.
  using Report = std::function<void(const std::string&)>;

  // Both links, and `interrupt`, must outlive it.
  LineBridge(PortLink& board, PortLink& far, const Interrupt& interrupt, Report report);

  // Until interrupted. A side that is lost is opened again as often as it takes; what comes for it
  // meanwhile is dropped. Errors: neither of the links has any that ends it; only what a bug makes
  // (usage).
  Result<void> run();

  // "12345 bytes to the board, 23456 back, 12 dropped"
  std::string counts() const;

 private:
  struct Side {
    PortLink& link;
    bool there = true;
    Time lost{}, next_try{};
    std::uint64_t taken = 0, dropped = 0;  // bytes for it
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
