// Mark in RAM that distinguishes an intended watchdog reset from a fault.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_RESTART_H
#define KAZ_FIRMWARE_RESTART_H

#include "firmware/h8s2128.h"

// First long word of the short RAM (FFFF00), reserved for the restart mark. The mark is valid only after a
// watchdog reset, because RAM is undefined after power-on.
#define KZ_RESTART_MARK (*(volatile u32*)0xFFFFFF00UL)
#define KZ_RESTART_COMMAND 0x52455354UL  // "REST"
#define KZ_RESTART_LOADER 0x4C4F4144UL   // "LOAD": the loader first waits for a host

// Returns 1 if the watchdog caused the last reset, and 0 if the RES pin caused the last reset.
static inline u8 kz_reset_by_watchdog(void) {
  return (u8)((SYSCR & SYSCR_XRST) == 0);
}

#endif
