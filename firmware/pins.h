// PWM, timer and port outputs of the servo board.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_PINS_H
#define KAZ_FIRMWARE_PINS_H

#include "firmware/h8s2128.h"
#include "shared/servo/snapshot.h"

// All outputs low (but TxD and the multiplexer selects), PWM and timers running at duty 0. On a shared
// line P50 stays an input: TxD floats while the transmitter is off.
void kz_pins_init(u8 shared_line);
void kz_pins_write(const kz_tick_output* output);
// Whatever happens: drivers off.
void kz_pins_off(void);

// What P4 shows besides the multiplexer selects, which are the A/D driver's.
extern volatile u8 kz_pins_p4;
extern volatile u8 kz_pins_selects;

// Selects input 0..7 of all three multiplexers. With interrupts off.
static inline void kz_pins_select(u8 input) {
  kz_pins_selects = input;
  P4DR = (u8)(kz_pins_p4 | input);
}

#endif
