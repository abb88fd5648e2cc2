// The 1 kHz tick: compare match A of the free-running timer.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/clock.h"

#include "firmware/h8s2128.h"
#include "shared/board/board.h"

#define COUNTS_PER_TICK (KZ_STATES_PER_TICK / 8)

static volatile u8 due;

u16 kz_clock_start_8states(void) {
  return (u16)((FRT_TCSR & FRT_TCSR_OVF) ? 0xFFFF : FRT_FRC);
}

void kz_clock_init(void) {
  due = 0;
  FRT_TCR = FRT_TCR_PHI_8;
  FRT_TOCR = 0;
  FRT_OCRA = COUNTS_PER_TICK - 1;
  FRT_TCSR = FRT_TCSR_CCLRA;
  FRT_FRC = 0;
  FRT_TIER = FRT_TIER_OCIAE | FRT_TIER_ONE;
}

u8 kz_clock_skip(void) {
  u8 ticks;
  KZ_INTERRUPTS_OFF();
  ticks = due;
  due = 0;
  KZ_INTERRUPTS_ON();
  return ticks;
}

u8 kz_clock_wait(void) {
  u8 ticks;
  KZ_INTERRUPTS_OFF();
  while (due == 0) {
    KZ_INTERRUPTS_ON_AND_SLEEP();
    KZ_INTERRUPTS_OFF();
  }
  ticks = due;
  due = 0;
  KZ_INTERRUPTS_ON();
  return ticks;
}

u16 kz_clock_busy_8states(void) {
  u16 count;
  u8 late;
  KZ_INTERRUPTS_OFF();
  count = FRT_FRC;
  late = due;
  if (FRT_TCSR & FRT_TCSR_OCFA) {
    // The next tick became due around the reading; behind the flag it is certain to be after.
    count = FRT_FRC;
    ++late;
  }
  KZ_INTERRUPTS_ON();
  return (u16)(count + (u16)(late * (u16)COUNTS_PER_TICK));
}

KZ_INTERRUPT void kz_clock_interrupt(void) {
  FRT_TCSR &= (u8)~FRT_TCSR_OCFA;  // reads the flag as 1, then writes 0: the chip wants both
  ++due;
}

void kz_watchdog_start(void) {
  WDT0_TCSR = WDT_TCSR_KEY | WDT_WATCHDOG | WDT_RUN | WDT_RESET | WDT_PHI_512;
}

void kz_watchdog_feed(void) {
  WDT0_TCNT = WDT_TCNT_KEY;
}

void kz_watchdog_reset(void) {
  KZ_INTERRUPTS_OFF();
  WDT0_TCSR = WDT_TCSR_KEY | WDT_WATCHDOG | WDT_RUN | WDT_RESET | WDT_PHI_2;
  for (;;) continue;
}
