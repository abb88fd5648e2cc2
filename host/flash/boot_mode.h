// Loads a program into a board's RAM through the boot mode of the H8S/2128.
// SPDX-License-Identifier: Apache-2.0
//
// The steps and bytes are taken from the boot mode chapters in the hardware manuals of the related H8S/2138A
// and H8S/2148. The manuals are ambiguous in two points, so the host accepts all variants. First point: after
// the byte H'55, the chip may answer with H'AA, or may send no answer. Second point: at the end of boot mode,
// the chip may send one byte H'AA, or two bytes H'AA.
#pragma once

#include <cstdint>
#include <span>

#include "host/link/link.h"

namespace kaz::host {

struct BootOptions {
  int baud = 9600;  // bit rate: 9600 or 4800; chips of the A-mask version also support 19200
  int tries = 60;   // maximum number of H'00 bytes sent
};

// Loads and starts `program`. Precondition: the board has been reset into boot mode. Returns once the program
// runs. Afterwards, the link has the bit rate BootOptions::baud. If the flash is not blank, the chip's boot
// program erases the whole flash. Errors contain the step and the bytes received.
Result<void> load_through_boot(Link& link, Clock& clock, std::span<const std::uint8_t> program,
                               const BootOptions& options = {});

}  // namespace kaz::host
