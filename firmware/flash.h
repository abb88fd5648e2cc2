// Erasing and programming the blocks of flash that hold no program.
// SPDX-License-Identifier: Apache-2.0
//
// While flash is written no code runs from it and no interrupt is served: the work is done by
// flash_ram.c, which is copied to RAM for it. It feeds the watchdog, and counts the ticks that
// become due meanwhile. Pulses and waits are those of the part's 32-byte generation (hardware
// manual, flash memory, flowcharts of programming and erasing).
#ifndef KAZ_FIRMWARE_FLASH_H
#define KAZ_FIRMWARE_FLASH_H

#include "shared/base/types.h"

#define KZ_FLASH_BLOCK 1024  // bytes of EB0..EB3, one behind the other from address 0

// Between the two interrupts are off and the code of flash_ram.c is in RAM.
void kz_flash_open(void);
// Ticks that became due between the two.
u16 kz_flash_close(void);

// Erases block EB`block`, 1..3. Returns 1 if every cell then read as erased.
u8 kz_flash_erase(u8 block);
// Programs the 32 bytes at `address`, a multiple of 32 in EB1..EB3, which have to be erased. Returns 1 if
// every cell then read right.
u8 kz_flash_program(u32 address, const u8* line);

#endif
