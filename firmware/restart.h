// Mark of an intended watchdog reset in RAM, so that the next start knows.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_RESTART_H
#define KAZ_FIRMWARE_RESTART_H

#include "firmware/h8s2128.h"

// The first word of the short RAM (FFFF00), which nothing else uses. Means something only after a
// watchdog reset: RAM holds anything after power-on.
#define KZ_RESTART_MARK (*(volatile u32*)0xFFFFFF00UL)
#define KZ_RESTART_COMMAND 0x52455354UL  // "REST"
#define KZ_RESTART_LOADER 0x4C4F4144UL   // "LOAD": the loader waits first

static inline u8 kz_reset_by_watchdog(void) {
  return (u8)((SYSCR & SYSCR_XRST) == 0);
}

#endif
