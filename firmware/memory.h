// Board settings in flash: calibration (EB1, EB2) and address (EB3).
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_MEMORY_H
#define KAZ_FIRMWARE_MEMORY_H

#include "shared/servo/servo.h"

// Copies the stored calibration and the stored address to `startup`. If flash has no valid copy of one of
// these values, the value in `startup` is unchanged.
void kz_memory_load(kz_startup* startup);
// Writes the sequence number and the number of erasures of the stored calibration to `input`.
void kz_memory_report(kz_tick_input* input);

// Store settings in flash and verify the stored copy. Return 1 on success. Interrupts are off for up to 3 s.
// Both functions add to `*ticks` the number of ticks that became due during the call.
u8 kz_memory_store_calibration(const kz_servo* servo, u16* ticks);
u8 kz_memory_store_address(const kz_servo* servo, u16* ticks);

#endif
