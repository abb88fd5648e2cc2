// Loads a program into a board's RAM through the boot mode of the H8S/2128.
// SPDX-License-Identifier: Apache-2.0
//
// Source of steps and bytes: hardware manuals of the related H8S/2138A and H8S/2148, boot mode. Where they
// are ambiguous, all variants are accepted: with or without H'AA after H'55, and one H'AA at the end or
// two.
#pragma once

#include <cstdint>
#include <span>

#include "host/link/link.h"

namespace kaz::host {

struct BootOptions {
  int baud = 9600;  // 9600 or 4800; also 19200 for parts with A mask
  int tries = 60;   // maximum number of H'00 sent
};

// Loads and starts `program`. Precondition: the board has been reset into boot mode. Returns once the
// program runs, and leaves the link at `baud`. The boot program erases the flash if it is not blank. Errors
// contain the step and the bytes received.
Result<void> load_through_boot(Link& link, Clock& clock, std::span<const std::uint8_t> program,
                               const BootOptions& options = {});

}  // namespace kaz::host
