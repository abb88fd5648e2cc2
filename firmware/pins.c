// PWM, timer and port outputs of the servo board.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/pins.h"

// phi/16, the slowest: 256 counts last 222 us, in 16 pulses of 72 kHz.
#define PWSL_RUN (PWSL_PWCKE | PWSL_PWCKS | PWSL_ONE)
#define P4_NOT_CLOCK_OUTPUT 0xBF  // P46 as an output would be the system clock
#define P5_TXD 0x01
#define P5_OUTPUTS 0x04  // P52
#define TMR_PERIOD 256   // counts of phi/2: 36 kHz

volatile u8 kz_pins_p4;
volatile u8 kz_pins_selects;

static void init_pwm(void) {
  u8 channel;
  PCSR = PCSR_PWCKB | PCSR_PWCKA;
  PWDPRA = 0;
  PWDPRB = 0;
  for (channel = 0; channel < 16; ++channel) {
    PWSL = (u8)(PWSL_RUN | channel);
    PWDR = 0;
  }
  P1DR = 0;
  P2DR = 0;
  PWOERA = 0xFF;
  PWOERB = 0xFF;
  P1DDR = 0xFF;
  P2DDR = 0xFF;
}

static void init_timers(void) {
  STCR = STCR_ICKS1 | STCR_ICKS0;
  TMR_TCORA0 = TMR_PERIOD - 1;
  TMR_TCORA1 = TMR_PERIOD - 1;
  TMR_TCSR0 = 0;
  TMR_TCSR1 = 0;
  TMR_TCR0 = TMR_CLEAR_AT_A | TMR_PHI_2;
  TMR_TCR1 = TMR_CLEAR_AT_A | TMR_PHI_2;
}

void kz_pins_init(u8 shared_line) {
  // Levels first, then directions: no output ever shows anything else.
  P3DR = 0;
  P4DR = KZ_P4_MUX_MASK;
  P5DR = P5_TXD;
  P6DR = 0;
  P3DDR = 0xFF;
  P4DDR = P4_NOT_CLOCK_OUTPUT;
  P5DDR = shared_line ? P5_OUTPUTS : P5_OUTPUTS | P5_TXD;
  P6DDR = 0xFF;
  kz_pins_p4 = 0;
  kz_pins_selects = KZ_P4_MUX_MASK;
  init_pwm();
  init_timers();
}

void kz_pins_write(const kz_tick_output* output) {
  const u8* duty = output->pw;
  // Not a loop: this is done in every tick.
#define PUT(channel)           \
  PWSL = PWSL_RUN | (channel); \
  PWDR = *duty++;
  PUT(0)
  PUT(1)
  PUT(2) PUT(3) PUT(4) PUT(5) PUT(6) PUT(7) PUT(8) PUT(9) PUT(10) PUT(11) PUT(12) PUT(13) PUT(14)
      PUT(15)
#undef PUT
      // Duty n: high from the period's start for n counts. At 0 the pin is a port, and low.
      if (output->tmo[0] != 0) {
    TMR_TCORB0 = (u8)(output->tmo[0] - 1);
    TMR_TCSR0 = TMR_HIGH_AT_A | TMR_LOW_AT_B;
  }
  else {
    TMR_TCSR0 = 0;
  }
  if (output->tmo[1] != 0) {
    TMR_TCORB1 = (u8)(output->tmo[1] - 1);
    TMR_TCSR1 = TMR_HIGH_AT_A | TMR_LOW_AT_B;
  } else {
    TMR_TCSR1 = 0;
  }
  P3DR = output->p3;
  P5DR = (u8)(output->p5 | P5_TXD);
  P6DR = output->p6;
  KZ_INTERRUPTS_OFF();
  kz_pins_p4 = output->p4;
  P4DR = (u8)(output->p4 | kz_pins_selects);
  KZ_INTERRUPTS_ON();
}

void kz_pins_off(void) {
  P4DR = KZ_P4_MUX_MASK;
}
