// Ctrl-C and termination end a program in order: motors off, files closed, links removed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/link/interrupt.h"

namespace kaz::tools {

// While it lives SIGINT, SIGTERM and SIGHUP request `interrupt`. One at a time in a process. A
// second signal ends the program at once.
class InterruptSignals {
 public:
  explicit InterruptSignals(host::Interrupt& interrupt);
  ~InterruptSignals();
  InterruptSignals(const InterruptSignals&) = delete;
  InterruptSignals& operator=(const InterruptSignals&) = delete;
};

}  // namespace kaz::tools
