// The 1 kHz tick, sleep between ticks, measured length of a tick, and the watchdog.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_CLOCK_H
#define KAZ_FIRMWARE_CLOCK_H

#include "shared/base/types.h"

// Time since start.S switched the timer on, in units of 8 states; 0xFFFF from 28 ms on. Before
// kz_clock_init.
u16 kz_clock_start_8states(void);
// Starts the tick.
void kz_clock_init(void);
// Sleeps until the next tick is due. Returns how many are due: more than 1 if some were missed.
u8 kz_clock_wait(void);
// How many ticks have become due and have not been waited for; they are forgotten.
u8 kz_clock_skip(void);
// Time since the tick that was waited for last became due, in units of 8 states.
u16 kz_clock_busy_8states(void);

void kz_watchdog_start(void);
// Not fed for 7.1 ms, the watchdog resets the chip.
void kz_watchdog_feed(void);
// Lets the watchdog reset the chip at once.
void kz_watchdog_reset(void);

#endif
