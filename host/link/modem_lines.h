// DTR and RTS: serial port outputs that may be wired to a board's reset and mode pins.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <sys/ioctl.h>

#include "shared/base/result.hpp"

namespace kaz::host {

class ModemLines {
 public:
  virtual ~ModemLines() = default;
  // Sets both lines. `true` is the active level (low at a TTL adapter's pins). Both lines change at once.
  virtual Result<void> set_dtr_rts(bool dtr, bool rts) = 0;
};

// Returns the value for TIOCMSET, given `lines` from TIOCMGET. The bits of all other lines are unchanged.
constexpr int with_dtr_rts(int lines, bool dtr, bool rts) {
  return (lines & ~(TIOCM_DTR | TIOCM_RTS)) | (dtr ? TIOCM_DTR : 0) | (rts ? TIOCM_RTS : 0);
}

}  // namespace kaz::host
