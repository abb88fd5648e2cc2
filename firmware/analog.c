// A/D conversion: AN0, AN1, AN2 in scan mode, once for each input of the multiplexers.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/analog.h"

#include "firmware/copy.h"
#include "firmware/h8s2128.h"
#include "firmware/pins.h"

// The slow, exact conversion (CKS = 0). The input that was just selected has 63 states to settle
// before AN0's sample is taken.
#define SCAN_STOPPED (ADCSR_ADIE | ADCSR_SCAN | ADCSR_AN0_TO_2)
#define SCAN_RUNNING (SCAN_STOPPED | ADCSR_ADST)
#define CODE_SHIFT 6

// The potentiometers' inputs are converted each time, of the supplies' two one, in turn, first.
#define LAST_POT_INPUT 5
#define OTHER_SUPPLY_INPUT(input) ((u8)((input) ^ 1))

static u16 code[KZ_ANALOG];
static u8 supply_input;
static volatile u8 scanning;

void kz_analog_init(void) {
  ADCSR = SCAN_STOPPED;
  supply_input = KZ_ANALOG_REFERENCE;
  scanning = 0;
}

void kz_analog_start(void) {
  supply_input = OTHER_SUPPLY_INPUT(supply_input);
  KZ_INTERRUPTS_OFF();
  ADCSR = SCAN_STOPPED;
  scanning = 1;
  kz_pins_select(supply_input);
  ADCSR = SCAN_RUNNING;
  KZ_INTERRUPTS_ON();
}

u8 kz_analog_ready(void) {
  return (u8)!scanning;
}

void kz_analog_take(u16* codes) {
  kz_copy(codes, code, sizeof code);
}

KZ_INTERRUPT void kz_analog_interrupt(void) {
  const u8 input = kz_pins_selects;
  u16* to = &code[input];
  (void)ADCSR;  // reads ADF as 1, so that the next write clears it
  ADCSR = SCAN_STOPPED;
  to[0] = ADDRA >> CODE_SHIFT;
  to[KZ_MUX_INPUTS] = ADDRB >> CODE_SHIFT;
  to[2 * KZ_MUX_INPUTS] = ADDRC >> CODE_SHIFT;
  if (input == LAST_POT_INPUT) {
    scanning = 0;
    return;
  }
  kz_pins_select(input < LAST_POT_INPUT ? (u8)(input + 1) : 0);
  ADCSR = SCAN_RUNNING;
}
