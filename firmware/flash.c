// Copies the flash routines to RAM, and calls them there.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/flash.h"

#include "firmware/flash_ram.h"
#include "firmware/h8s2128.h"

#define BLOCK_WORDS (KZ_FLASH_BLOCK / 2)
#define TRAP 0x5700  // TRAPA #0: nobody gets here by mistake and writes flash

// kaz.ld
extern const u16 kz_ram_code_load[];
extern u16 kz_ram_code_start[];
extern u16 kz_ram_code_end[];

static u16 ticks;

void kz_flash_open(void) {
  const u16* from = kz_ram_code_load;
  u16* to = kz_ram_code_start;
  while (to < kz_ram_code_end) *to++ = *from++;
  ticks = 0;
  KZ_INTERRUPTS_OFF();
  STCR |= STCR_FLSHE;
}

u16 kz_flash_close(void) {
  u16* to = kz_ram_code_start;
  STCR &= (u8)~STCR_FLSHE;
  KZ_INTERRUPTS_ON();
  while (to < kz_ram_code_end) *to++ = TRAP;
  return ticks;
}

u8 kz_flash_erase(u8 block) {
  return kz_flash_ram_erase((u8)(1 << block), (volatile u16*)((u32)block * KZ_FLASH_BLOCK), &ticks);
}

u8 kz_flash_program(u32 address, const u8* line) {
  return kz_flash_ram_program((volatile u16*)address, (const u16*)line, &ticks);
}
