// The firmware: one tick a millisecond, sleep in between.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/analog.h"
#include "firmware/clock.h"
#include "firmware/h8s2128.h"
#include "firmware/pins.h"
#include "firmware/serial.h"
#include "shared/servo/servo.h"

// What the tick works on. Global, so that an emulator finds them by name.
kz_tick_input kz_input;
kz_tick_output kz_output;
kz_servo kz_servo_state;
kz_startup kz_startup_found;

// kz_tick(&kz_servo_state, &kz_input, &kz_output), between two labels (start.S).
void kz_tick_begin(void);

static void start_modules(void) {
  MSTPCRH = MSTPCRH_RESET & (u8) ~(MSTPCRH_FRT | MSTPCRH_TMR01 | MSTPCRH_PWM | MSTPCRH_ADC);
  MSTPCRL = MSTPCRL_RESET & (u8)~MSTPCRL_SCI0;
}

// Only what has changed since the last tick; the rest stays.
static void take_snapshot(u8 ticks) {
  kz_input.tick += ticks;
  kz_input.missed = (u16)(ticks - 1);
  kz_analog_take(kz_input.analog);
  kz_serial_take(&kz_input);
  kz_input.tx_room = kz_serial_room();
}

static void run_tick(u8 ticks) {
  u8 converted;
  u16 busy;
  kz_pins_write(&kz_output);
  kz_serial_send(kz_output.tx, kz_output.tx_count);
  converted = kz_analog_ready();
  take_snapshot(ticks);
  kz_analog_start();
  kz_tick_begin();
  // A converter that does not finish its scan must not go on looking like joints that stand still.
  if (converted) kz_watchdog_feed();
  busy = kz_clock_busy_8states();
  kz_input.busy_8states = busy;
  if (busy > kz_input.worst_8states) kz_input.worst_8states = busy;
}

void kz_main(u16 image_crc) {
  u8 scan;
  start_modules();
  kz_pins_init();
  kz_serial_init();
  kz_analog_init();
  kz_startup_nominal(&kz_startup_found);
  kz_startup_found.image_crc = image_crc;
  kz_startup_found.reset_cause = (SYSCR & SYSCR_XRST) ? KZ_RESET_POWER : KZ_RESET_WATCHDOG;
  kz_servo_init(&kz_servo_state, &kz_startup_found, &kz_output);
  kz_input.tick = 0xFFFFFFFFUL;  // the first tick is number 0

  kz_watchdog_start();
  for (scan = 0; scan < 2; ++scan) {  // then every input has been converted
    kz_analog_start();
    while (!kz_analog_ready()) continue;
  }
  kz_clock_init();
  for (;;) run_tick(kz_clock_wait());
}

// No source of this interrupt is ever switched on: memory or the chip is damaged. The watchdog
// resets.
KZ_INTERRUPT void kz_unexpected(void) {
  kz_pins_off();
  for (;;) continue;
}
