// The two outputs of a serial port that may be wired to a board's reset and mode pins.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <sys/ioctl.h>

#include "shared/base/result.hpp"

namespace kaz::host {

class ModemLines {
 public:
  virtual ~ModemLines() = default;
  // True is the active level (low at a TTL adapter's pins). Both change at once.
  virtual Result<void> set_dtr_rts(bool dtr, bool rts) = 0;
};

// What TIOCMSET is to be given where TIOCMGET gave `lines`: the other lines stay as they are.
constexpr int with_dtr_rts(int lines, bool dtr, bool rts) {
  return (lines & ~(TIOCM_DTR | TIOCM_RTS)) | (dtr ? TIOCM_DTR : 0) | (rts ? TIOCM_RTS : 0);
}

}  // namespace kaz::host
