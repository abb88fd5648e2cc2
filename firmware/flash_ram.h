// Flash routines in RAM, which flash.c calls.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_FLASH_RAM_H
#define KAZ_FIRMWARE_FLASH_RAM_H

#include "shared/base/types.h"

// Return 1 if the flash was verified, 0 if not or after an error of the chip (FLER). Both functions add to
// `*ticks` the number of ticks that became due meanwhile. `blocks` is the value of EBR2, `first` the start
// of the block.
u8 kz_flash_ram_erase(u8 blocks, volatile u16* first, u16* ticks);
u8 kz_flash_ram_program(volatile u16* to, const u16* wanted, u16* ticks);

#endif
