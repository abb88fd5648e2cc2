// Entry into exception handling, shared by TRAPA and interrupts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

// Stacks PC and CCR, sets the mask bits and gives the handler's first instruction. Takes no time
// itself.
const Insn* enter_exception(Cpu& c, const Insn* from, std::uint32_t return_pc, unsigned vector);

}  // namespace kaz::h8s
