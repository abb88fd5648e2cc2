// Board settings in flash: calibration (EB1, EB2) and address (EB3).
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_MEMORY_H
#define KAZ_FIRMWARE_MEMORY_H

#include "shared/servo/servo.h"

// Copies stored calibration and address to `startup`. If there is no valid copy of a value in flash,
// `startup` keeps its value.
void kz_memory_load(kz_startup* startup);
// Writes sequence number and erasures of the stored calibration to the snapshot.
void kz_memory_report(kz_tick_input* input);

// Store the settings and read them back. Return 1 on success. Interrupts are off for up to 3 s. `*ticks`
// increases by the number of ticks that became due meanwhile.
u8 kz_memory_store_calibration(const kz_servo* servo, u16* ticks);
u8 kz_memory_store_address(const kz_servo* servo, u16* ticks);

#endif
