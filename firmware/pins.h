// PWM, timer and port outputs of the servo board.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_PINS_H
#define KAZ_FIRMWARE_PINS_H

#include "firmware/h8s2128.h"
#include "shared/servo/snapshot.h"

// Sets all outputs low, except TxD and the multiplexer selects, and starts PWM and timers with duty 0. On a
// shared line P50 stays an input, so that TxD floats while the transmitter is off.
void kz_pins_init(u8 shared_line);
// Writes the outputs of a tick to the pins.
void kz_pins_write(const kz_tick_output* output);
// Disables all motor drivers, for fatal errors.
void kz_pins_off(void);

// State of P4. The A/D driver sets the multiplexer selects in kz_pins_selects; kz_pins_p4 has all other bits.
extern volatile u8 kz_pins_p4;
extern volatile u8 kz_pins_selects;

// Selects input 0..7 of all three multiplexers. Interrupts must be off.
static inline void kz_pins_select(u8 input) {
  kz_pins_selects = input;
  P4DR = (u8)(kz_pins_p4 | input);
}

#endif
