// What the simulator behind a port says of itself: how far it has fallen behind the wall clock, which mcu it
// runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/interrupt.h"
#include "host/link/lateness.h"

namespace kaz::tools {

// Reads it from the control socket beside the port (`kaz sim`). Null if there is none, as at a real port.
// Once interrupted, it waits for the reply for 0.3 s at most: what was measured before is still judged.
host::LatenessMeter::TimeLost time_lost_behind(const std::string& port, host::Interrupt& interrupt);

// "native" or "h8", from the same socket; empty if there is none, or it does not say.
std::string simulated_mcu(const std::string& port, const host::Interrupt& interrupt);

}  // namespace kaz::tools
