// Loads a program into a board's RAM through the boot mode of the H8S/2128.
// SPDX-License-Identifier: Apache-2.0
//
// Steps and bytes: hardware manuals of the related H8S/2138A and H8S/2148, boot mode. Where they are
// ambiguous, all variants are accepted: H'AA after H'55 or not, one H'AA at the end or two.
#pragma once

#include <cstdint>
#include <span>

#include "host/link/link.h"

namespace kaz::host {

struct BootOptions {
  int baud = 9600;  // 9600 or 4800; parts with A mask take 19200 too
  int tries = 60;   // H'00 sent before giving up
};

// The board has been reset into boot mode. Returns once the program runs; the link is left at `baud`.
// The boot program erases the flash if it is not blank. Errors contain the step and what was received.
Result<void> load_through_boot(Link& link, Clock& clock, std::span<const std::uint8_t> program,
                               const BootOptions& options = {});

}  // namespace kaz::host
