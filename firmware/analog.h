// A/D conversion of all potentiometers and supplies: 8 multiplexer inputs of AN0, AN1, AN2 each.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_ANALOG_H
#define KAZ_FIRMWARE_ANALOG_H

#include "shared/servo/tick.h"

void kz_analog_init(void);
// Starts a scan, which goes on by interrupts and takes about 7,000 states.
void kz_analog_start(void);
// The last scan is done.
u8 kz_analog_ready(void);
// Copies the codes of the last scan.
void kz_analog_take(u16* codes);

#endif
