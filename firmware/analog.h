// A/D conversion: potentiometers and supplies on the multiplexers at AN0..AN2, inertial sensor at AN3..AN5.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_ANALOG_H
#define KAZ_FIRMWARE_ANALOG_H

#include "shared/servo/snapshot.h"

// Stops the converter and prepares the first scan.
void kz_analog_init(void);
// Starts a scan, which runs in interrupts and takes about 6,500 states. Each scan first converts multiplexer
// input 6 or 7 (supply, temperature, reference), and then the potentiometers. Inputs 6 and 7 alternate from
// scan to scan. AN3 is converted during the scan, AN4 and AN5 after the scan.
void kz_analog_start(void);
// Returns 1 once the scan is complete.
u8 kz_analog_ready(void);
// Copies the codes of the last scan to `codes`, which has KZ_ANALOG elements.
void kz_analog_take(u16* codes);

#endif
