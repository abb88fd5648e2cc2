// Status of the simulator behind a port: its lag behind the wall clock, and its kind of microcontroller.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/interrupt.h"
#include "host/link/lateness.h"

namespace kaz::tools {

// Returns a function that reads the simulator's lag from the control socket beside the port (`kaz sim`).
// Returns null if there is no socket, for example at a real port. After an interrupt the function waits at
// most 0.3 s for the reply, so that a run's end can still be evaluated. `interrupt` must outlive the
// function.
host::LatenessMeter::TimeLost time_lost_behind(const std::string& port, host::Interrupt& interrupt);

// Returns the simulator's kind of microcontroller, "native" or "h8", from the control socket beside the port.
// Returns "" if there is no socket or no valid reply.
std::string simulated_mcu(const std::string& port, const host::Interrupt& interrupt);

}  // namespace kaz::tools
