// The 1 kHz tick, sleep between ticks, tick duration, and the watchdog.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_CLOCK_H
#define KAZ_FIRMWARE_CLOCK_H

#include "shared/base/types.h"

// Returns the time since start.S started the timer, in units of 8 states; 0xFFFF after 28 ms or more. Must be
// called before kz_clock_init.
u16 kz_clock_start_8states(void);
// Starts the periodic tick.
void kz_clock_init(void);
// Sleeps until the next tick is due. Returns the number of due ticks: more than 1 if ticks were missed.
u8 kz_clock_wait(void);
// Returns the number of due ticks without waiting, and discards these ticks.
u8 kz_clock_skip(void);
// Returns the time since the current tick became due, in units of 8 states. The current tick is the tick for
// which kz_clock_wait returned last.
u16 kz_clock_busy_8states(void);

void kz_watchdog_start(void);
// Restarts the watchdog's timeout. The chip is reset after 7.1 ms without a call.
void kz_watchdog_feed(void);
// Resets the chip at once through the watchdog. Does not return.
void kz_watchdog_reset(void);

#endif
