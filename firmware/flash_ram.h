// Flash routines in RAM, which flash.c calls.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_FLASH_RAM_H
#define KAZ_FIRMWARE_FLASH_RAM_H

#include "shared/base/types.h"

// Both functions verify the flash at the end. They return 1 if the verification succeeded. They return 0 if
// the verification failed or the chip reported an error (FLER). Both functions add to `*ticks` the number of
// ticks that became due during the call. `blocks` is the value for EBR2, and `first` is the start of the
// block.
u8 kz_flash_ram_erase(u8 blocks, volatile u16* first, u16* ticks);
u8 kz_flash_ram_program(volatile u16* to, const u16* wanted, u16* ticks);

#endif
