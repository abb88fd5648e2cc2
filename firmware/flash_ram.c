// Erases and programs flash. Runs in RAM: calls nothing and reads nothing that is in flash.
// SPDX-License-Identifier: Apache-2.0
//
// Steps, waits and pulses: hardware manual, flash memory, flowcharts of programming and erasing for
// the 32-byte generation. P and E act only after their setup bits; interrupts are off throughout.
#include "firmware/flash_ram.h"

#include "firmware/flash.h"
#include "firmware/h8s2128.h"

#define WORDS_OF_LINE 16
#define WORDS_OF_BLOCK (KZ_FLASH_BLOCK / 2)
#define ERASED 0xFFFF

#define PROGRAM_PULSES 1000  // at most
#define PROGRAM_US 180       // 150..200
#define ERASE_PULSES 230     // at most: 1.2 s
#define ERASE_SLICES 10      // a pulse: 10 * 510 us, of 5..10 ms
#define ERASE_SLICE_US 510
#define SERVE_EVERY 64  // words that are verified; takes 0.2 ms

// A loop of 3 states at 18.432 MHz: 6.144 to the microsecond.
#define WAIT_US(us)                                                      \
  do {                                                                   \
    u16 left = (u16)((us)*6144UL / 1000 + 1);                            \
    __asm__ volatile("0:\tdec.w #1,%0\n\tbne 0b" : "+r"(left) : : "cc"); \
  } while (0)

// Called at least once in 0.6 ms: a tick lasts 1 ms, the watchdog waits for 7.1 ms.
static void __attribute__((noinline)) serve(u16* ticks) {
  WDT0_TCNT = WDT_TCNT_KEY;
  if (FRT_TCSR & FRT_TCSR_OCFA) {
    FRT_TCSR &= (u8)~FRT_TCSR_OCFA;
    ++*ticks;
  }
}

static inline void begin(void) {
  FLMCR1 = FLMCR1_SWE;
  WAIT_US(10);
}

static inline void end(void) {
  FLMCR1 = 0;
  WAIT_US(100);
}

// In verification a dummy write makes a word readable.
static inline u16 verified_word(volatile u16* at) {
  *(volatile u8*)at = 0xFF;
  WAIT_US(2);
  return *at;
}

static u8 is_erased(volatile u16* at, u16* ticks) {
  u16 word;
  u8 erased = 1;
  FLMCR1 = FLMCR1_SWE | FLMCR1_EV;
  WAIT_US(20);
  for (word = 0; word < WORDS_OF_BLOCK; ++word) {
    if (word % SERVE_EVERY == 0) serve(ticks);
    if (verified_word(at++) != ERASED) {
      erased = 0;
      break;
    }
  }
  FLMCR1 = FLMCR1_SWE;
  WAIT_US(5);
  return erased;
}

u8 kz_flash_ram_erase(u8 blocks, volatile u16* first, u16* ticks) {
  u8 done = 0;
  u16 pulse;
  begin();
  EBR1 = 0;
  EBR2 = blocks;
  for (pulse = 0; pulse < ERASE_PULSES && !done; ++pulse) {
    u8 slice;
    serve(ticks);
    FLMCR2 = FLMCR2_ESU;
    WAIT_US(200);
    FLMCR1 = FLMCR1_SWE | FLMCR1_E;
    for (slice = 0; slice < ERASE_SLICES; ++slice) {
      WAIT_US(ERASE_SLICE_US);
      serve(ticks);
    }
    FLMCR1 = FLMCR1_SWE;
    WAIT_US(10);
    FLMCR2 = 0;
    WAIT_US(10);
    done = is_erased(first, ticks);
    if (FLMCR2 & FLMCR2_FLER) {
      done = 0;
      break;
    }
  }
  EBR2 = 0;
  end();
  return done;
}

#define PROGRAMMED 1
#define NOT_YET 0
#define HOPELESS 2  // a cell is programmed that must not be

// Looks at the line; `next` becomes what the next pulse has to program: cells that are to be 0 and
// are not.
static u8 __attribute__((noinline)) programmed(volatile u16* at, const u16* wanted, u16* next) {
  u8 result = PROGRAMMED;
  u8 word;
  FLMCR1 = FLMCR1_SWE | FLMCR1_PV;
  WAIT_US(4);
  for (word = 0; word < WORDS_OF_LINE; ++word) {
    const u16 is = verified_word(at++);
    const u16 missing = (u16)(is & ~*wanted);
    if ((u16)(~is & *wanted) != 0) result = HOPELESS;
    if (missing != 0 && result == PROGRAMMED) result = NOT_YET;
    *next++ = (u16)~missing;
    ++wanted;
  }
  FLMCR1 = FLMCR1_SWE;
  WAIT_US(4);
  return result;
}

u8 kz_flash_ram_program(volatile u16* to, const u16* wanted, u16* ticks) {
  u16 next[WORDS_OF_LINE];
  u8 result = NOT_YET;
  u16 pulse;
  u8 i;
  for (i = 0; i < WORDS_OF_LINE; ++i) next[i] = wanted[i];
  begin();
  for (pulse = 0; pulse < PROGRAM_PULSES && result == NOT_YET; ++pulse) {
    const u8* byte = (const u8*)next;
    volatile u8* latch = (volatile u8*)to;
    for (i = 0; i < 2 * WORDS_OF_LINE; ++i) *latch++ = *byte++;
    serve(ticks);
    FLMCR2 = FLMCR2_PSU;
    WAIT_US(50);
    FLMCR1 = FLMCR1_SWE | FLMCR1_P;
    WAIT_US(PROGRAM_US);
    FLMCR1 = FLMCR1_SWE;
    WAIT_US(10);
    FLMCR2 = 0;
    WAIT_US(10);
    result = programmed(to, wanted, next);
    if (FLMCR2 & FLMCR2_FLER) result = HOPELESS;
  }
  end();
  return (u8)(result == PROGRAMMED);
}
