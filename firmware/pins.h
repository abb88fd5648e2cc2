// PWM, timer and port outputs of the servo board.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_PINS_H
#define KAZ_FIRMWARE_PINS_H

#include "shared/servo/tick.h"

// All outputs low (but TxD and the multiplexer selects), PWM and timers running at duty 0.
void kz_pins_init(void);
void kz_pins_write(const kz_tick_output* output);
// Whatever happens: drivers off.
void kz_pins_off(void);

// Selects input 0..7 of all three multiplexers. With interrupts off.
void kz_pins_select(u8 input);

#endif
