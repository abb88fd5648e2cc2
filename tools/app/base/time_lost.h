// How far the simulator behind a port has fallen behind the wall clock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/interrupt.h"
#include "host/link/lateness.h"

namespace kaz::tools {

// Reads it from the control socket beside the port (`kaz sim`). Null if there is none, as at a real port.
host::LatenessMeter::TimeLost time_lost_behind(const std::string& port,
                                               const host::Interrupt& interrupt);

}  // namespace kaz::tools
