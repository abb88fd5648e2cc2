// What flash.c calls in RAM.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_FLASH_RAM_H
#define KAZ_FIRMWARE_FLASH_RAM_H

#include "shared/base/types.h"

// Return 1 if verified, 0 if not (also: FLER). To `*ticks` they add the ticks that became due.
u8 kz_flash_ram_erase(u8 blocks, volatile u16* first, u16* ticks);
u8 kz_flash_ram_program(volatile u16* to, const u16* wanted, u16* ticks);

#endif
