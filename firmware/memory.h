// What the board remembers in flash: calibration (EB1, EB2) and address (EB3).
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_MEMORY_H
#define KAZ_FIRMWARE_MEMORY_H

#include "shared/servo/servo.h"

// Reads both logs into `startup`; what is not there stays as it is.
void kz_memory_load(kz_startup* startup);
// Number of the stored calibration and wear, for the snapshot.
void kz_memory_report(kz_tick_input* input);

// Store and read back; 1 if that went well. For up to 3 s no interrupt is served: to `*ticks` the ticks
// that became due are added.
u8 kz_memory_store_calibration(const kz_servo* servo, u16* ticks);
u8 kz_memory_store_address(const kz_servo* servo, u16* ticks);

#endif
