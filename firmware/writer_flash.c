// Programs flash while bytes come in.
// SPDX-License-Identifier: Apache-2.0
//
// Steps, waits and pulses: hardware manual, flash memory, flowcharts of programming and erasing for the
// 32-byte generation, as in flash_ram.c; here every wait receives.
#include "firmware/h8s2128.h"
#include "firmware/writer.h"

#define WORDS 16
#define PROGRAM_PULSES 1000
#define WORDS_BETWEEN_POLLS 4

// In verification a dummy write makes a word readable; 2 us later it may be read.
u16 kz_writer_verified_word(volatile u16* at) {
  u16 left = 14;
  *(volatile u8*)at = 0xFF;
  __asm__ volatile("0:\tdec.w #1,%0\n\tbne 0b" : "+r"(left) : : "cc");
  return *at;
}

// Longer than the longest of the waits that are short anyway: 20 us behind EV.
static void settle(void) {
  kz_writer_wait(KZ_COUNTS(20));
}

void kz_writer_set_flash(u8 bits) {
  FLMCR1 = (u8)(FLMCR1_SWE | bits);
  settle();
}

u8 kz_writer_end_flash(u8 status) {
  if (FLMCR2 & FLMCR2_FLER) status = KZ_WRITER_LOCKED;
  FLMCR1 = 0;
  kz_writer_wait(KZ_COUNTS(100));
  return status;
}

// Setup bit, its wait, pulse bit, its length, and both off.
void kz_writer_pulse(u8 setup, u16 setup_counts, u8 on, u16 counts) {
  FLMCR2 = setup;
  kz_writer_wait(setup_counts);
  FLMCR1 = FLMCR1_SWE | on;
  kz_writer_wait(counts);
  kz_writer_set_flash(0);
  FLMCR2 = 0;
  settle();
}

// What the next pulse has to program, into `next`: cells that are to be 0 and are not.
static u8 written(volatile u16* at, const u16* wanted, u16* next) {
  u8 status = KZ_WRITER_OK;
  u8 word;
  kz_writer_set_flash(FLMCR1_PV);
  for (word = 0; word < WORDS; ++word) {
    u16 is;
    if (word % WORDS_BETWEEN_POLLS == 0) kz_writer_poll();
    is = kz_writer_verified_word(at++);
    if ((u16)(~is & *wanted) != 0) {
      status = KZ_WRITER_NOT_BLANK;
    } else if (is != *wanted && status == KZ_WRITER_OK) {
      status = KZ_WRITER_NOT_WRITTEN;
    }
    *next++ = (u16)(~is | *wanted);
    ++wanted;
  }
  kz_writer_set_flash(0);
  return status;
}

u8 kz_writer_program(u32 address, const u16* wanted) {
  volatile u16* const to = (volatile u16*)address;
  u16 next[WORDS];
  u16 left = PROGRAM_PULSES;
  u8 status;
  kz_writer_set_flash(0);
  status = written(to, wanted, next);
  while (left != 0 && status == KZ_WRITER_NOT_WRITTEN) {
    const u8* byte = (const u8*)next;
    volatile u8* latch = (volatile u8*)to;
    u8 i;
    --left;
    for (i = 0; i < 2 * WORDS; ++i) *latch++ = *byte++;
    kz_writer_poll();
    kz_writer_pulse(FLMCR2_PSU, KZ_COUNTS(50), FLMCR1_P, KZ_COUNTS(165));
    if (FLMCR2 & FLMCR2_FLER) break;
    status = written(to, wanted, next);
  }
  return kz_writer_end_flash(status);
}
