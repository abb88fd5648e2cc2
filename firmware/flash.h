// Erases and programs the flash blocks that contain no program code.
// SPDX-License-Identifier: Apache-2.0
//
// No code can run from flash while the flash is written. Therefore interrupts are off, and the code of
// flash_ram.c runs in RAM. This code feeds the watchdog and counts the ticks that become due. The durations
// of pulses and waits are those of chips with 32-byte flash lines. Source: hardware manual, flash memory,
// flowcharts of programming and erasing.
#ifndef KAZ_FIRMWARE_FLASH_H
#define KAZ_FIRMWARE_FLASH_H

#include "shared/base/types.h"

#define KZ_FLASH_BLOCK 1024  // size of each block EB0..EB3, bytes; EB0 is at address 0

// Copies the code of flash_ram.c to RAM and switches interrupts off. Required before erase and program.
void kz_flash_open(void);
// Switches interrupts on. Returns the number of ticks that became due since kz_flash_open.
u16 kz_flash_close(void);

// Erases block EB`block`, 1..3. Returns 1 if all cells are erased after the call.
u8 kz_flash_erase(u8 block);
// Programs 32 erased bytes at `address`, a multiple of 32 within EB1..EB3. `line` must be word-aligned.
// Returns 1 if all cells are equal to `line` after the call.
u8 kz_flash_program(u32 address, const u8* line);

#endif
