// A/D conversion: AN0, AN1, AN2 in scan mode, once for each input of the multiplexers, AN3 with the
// first of them; then AN4 and AN5.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/analog.h"

#include "firmware/copy.h"
#include "firmware/h8s2128.h"
#include "firmware/pins.h"

// The slow, exact conversion (CKS = 0). The input that was just selected has 63 states to settle
// before AN0's sample is taken.
#define SCAN_STOPPED (ADCSR_ADIE | ADCSR_SCAN | ADCSR_AN0_TO_3)
#define SCAN_RUNNING (SCAN_STOPPED | ADCSR_ADST)

// The potentiometers' inputs are converted each time, of the supplies' two one, in turn, first.
#define OTHER_SUPPLY_INPUT(input) ((u8)((input) ^ 1))

// The interrupt (analog_interrupt.S) fills the codes and ends the scan after the last input. The
// inertial option's three stand in data registers: AN3's is that of no other channel, those of AN0 and
// AN1 are AN4's and AN5's in between.
u16 kz_analog_code[KZ_ANALOG];
volatile u8 kz_analog_scanning;
static u8 supply_input;

void kz_analog_init(void) {
  ADCSR = SCAN_STOPPED;
  supply_input = KZ_ANALOG_REFERENCE;
  kz_analog_scanning = 0;
}

void kz_analog_start(void) {
  supply_input = OTHER_SUPPLY_INPUT(supply_input);
  KZ_INTERRUPTS_OFF();
  // What goes round AN4 and AN5 stops first, and its flag goes: it would be an interrupt.
  ADCSR = (u8)(ADCSR & (u8) ~(ADCSR_ADF | ADCSR_ADST));
  ADCSR = SCAN_STOPPED;
  kz_analog_scanning = 1;
  kz_pins_select(supply_input);
  ADCSR = SCAN_RUNNING;
  KZ_INTERRUPTS_ON();
}

u8 kz_analog_ready(void) {
  return (u8)!kz_analog_scanning;
}

void kz_analog_take(u16* codes) {
  kz_copy(codes, kz_analog_code, sizeof kz_analog_code);
  codes[KZ_ANALOG_YAW_RATE] = (u16)(ADDRD >> 6);
  codes[KZ_ANALOG_FORWARD_FORCE] = (u16)(ADDRA >> 6);
  codes[KZ_ANALOG_LEFT_FORCE] = (u16)(ADDRB >> 6);
}
