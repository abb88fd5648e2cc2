// A/D conversion of all potentiometers and supplies, the multiplexer inputs of AN0, AN1 and AN2, and
// of the inertial option's AN3, AN4 and AN5.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_ANALOG_H
#define KAZ_FIRMWARE_ANALOG_H

#include "shared/servo/snapshot.h"

void kz_analog_init(void);
// Starts a scan, which goes on by interrupts and takes about 6,500 states: the inputs of the
// potentiometers, and of inputs 6 and 7 (supply, temperature, reference) the one or the other in
// turn; last the inertial option.
void kz_analog_start(void);
// The last scan is done.
u8 kz_analog_ready(void);
// Copies the codes of the last scan.
void kz_analog_take(u16* codes);

#endif
