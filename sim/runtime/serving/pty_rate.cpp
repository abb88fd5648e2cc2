// The rate of a pty in baud, whatever it is. <asm/termbits.h>, which has it, excludes <termios.h>.
// SPDX-License-Identifier: Apache-2.0
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include "sim/runtime/serving/pty.h"

namespace kaz::sim {

long Pty::rate() const {
  termios2 settings{};
  // The master shares the slave's settings.
  if (ioctl(master_.get(), TCGETS2, &settings) != 0) return 0;
  return static_cast<long>(settings.c_ospeed);
}

}  // namespace kaz::sim
