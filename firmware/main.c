// The firmware: start, one tick a millisecond, sleep or the action that a tick requested in between.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/analog.h"
#include "firmware/clock.h"
#include "firmware/h8s2128.h"
#include "firmware/memory.h"
#include "firmware/pins.h"
#include "firmware/restart.h"
#include "firmware/serial.h"
#include "shared/flash/image.h"
#include "shared/protocol/messages.h"
#include "shared/servo/tick.h"

// What the tick works on. Global, so that an emulator finds them by name.
kz_tick_input kz_input;
kz_tick_output kz_output;
kz_servo kz_servo_state;
kz_startup kz_startup_found;

// The bytes of kz_output are queued already. The tick reads its last output, so that stays as it is.
static u8 released;

// kz_tick(&kz_servo_state, &kz_input, &kz_output), between two labels (start.S).
void kz_tick_begin(void);

static void start_modules(void) {
  MSTPCRH = MSTPCRH_RESET & (u8) ~(MSTPCRH_FRT | MSTPCRH_TMR01 | MSTPCRH_PWM | MSTPCRH_ADC);
  MSTPCRL = MSTPCRL_RESET & (u8)~MSTPCRL_SCI0;
}

// Then every input has been converted.
static void scan_twice(void) {
  u8 scan;
  for (scan = 0; scan < 2; ++scan) {
    kz_analog_start();
    while (!kz_analog_ready()) continue;
  }
}

// Only what has changed since the last tick; the rest stays.
static void take_snapshot(u16 ticks) {
  kz_input.tick += ticks;
  kz_input.missed = (u16)(ticks - 1);
  kz_analog_take(kz_input.analog);
  kz_serial_take(&kz_input);
  kz_input.tx_room = kz_serial_room();
}

static void release_output(void) {
  kz_pins_write(&kz_output);
  if (!released) kz_serial_send(kz_output.tx, kz_output.tx_count);
}

static void run_tick(u16 ticks) {
  u8 converted;
  u16 busy;
  release_output();
  released = 0;
  converted = kz_analog_ready();
  take_snapshot(ticks);
  kz_analog_start();
  kz_tick_begin();
  // A converter that does not finish its scan must not go on looking like joints that stand still.
  if (converted) kz_watchdog_feed();
  busy = kz_clock_busy_8states();
  kz_input.busy_8states = busy;
  if (busy > kz_input.worst_8states) kz_input.worst_8states = busy;
  kz_input.result = KZ_RESULT_NONE;
}

static void restart(u32 mark) {
  KZ_RESTART_MARK = mark;
  kz_watchdog_reset();
}

// The last tick's action, once its outputs are at the pins and its bytes have left: 5.6 ms at
// most. Returns the ticks that became due meanwhile: the next one begins on time.
static u16 act(void) {
  u16 ticks = 0;
  u8 done = 0;
  release_output();
  released = 1;
  while (!kz_serial_idle()) continue;
  if (kz_output.p4 & KZ_P4_ENABLE) {
    // No tick requests it; and no motor is left alone for seconds.
  } else if (kz_output.action == KZ_ACTION_STORE_CALIBRATION) {
    done = kz_memory_store_calibration(&kz_servo_state, &ticks);
  } else if (kz_output.action == KZ_ACTION_STORE_ADDRESS) {
    done = kz_memory_store_address(&kz_servo_state, &ticks);
  } else if (kz_output.action == KZ_ACTION_RESET) {
    restart(KZ_RESTART_COMMAND);
  } else if (kz_output.action == KZ_ACTION_LOADER) {
    restart(KZ_RESTART_LOADER);
  }
  kz_memory_report(&kz_input);
  kz_output.action = KZ_ACTION_NONE;
  kz_input.result = done ? KZ_RESULT_DONE : KZ_RESULT_FAILED;
  kz_watchdog_feed();
  scan_twice();  // the tick's codes are no older than ever
  return (u16)(ticks + kz_clock_skip());
}

// `ram_wrong`: bits that the test of RAM found wrong.
static void find_out(u16 image_crc, u16 ram_wrong) {
  kz_startup* found = &kz_startup_found;
  kz_startup_nominal(found);
  found->image_crc = image_crc;
  found->reset_cause = KZ_RESET_POWER;
  if (kz_reset_by_watchdog()) {
    found->reset_cause =
        KZ_RESTART_MARK == KZ_RESTART_COMMAND ? KZ_RESET_COMMAND : KZ_RESET_WATCHDOG;
  }
  KZ_RESTART_MARK = 0;
  found->tests_done = KZ_TEST_RAM | KZ_TEST_FLASH;
  if (ram_wrong != 0) found->tests_failed |= KZ_TEST_RAM;
  if (image_crc != ((const kz_image_header*)KZ_APPLICATION_HEADER)->crc)
    found->tests_failed |= KZ_TEST_FLASH;
  kz_memory_load(found);
  kz_memory_report(&kz_input);
}

void kz_main(u16 image_crc, u16 ram_wrong) {
  u16 ticks = 0;
  start_modules();
  find_out(image_crc, ram_wrong);
  kz_pins_init(kz_startup_found.shared_line);
  kz_serial_init(kz_startup_found.shared_line);
  kz_analog_init();
  kz_watchdog_start();
  scan_twice();
  kz_analog_take(kz_input.analog);
  kz_startup_test_analog(&kz_startup_found, kz_input.analog);
  kz_startup_found.start_8states = kz_clock_start_8states();
  kz_servo_init(&kz_servo_state, &kz_startup_found, &kz_output);
  kz_input.tick = 0xFFFFFFFFUL;  // the first tick is number 0
  kz_clock_init();
  for (;;) {
    run_tick((u16)(ticks + kz_clock_wait()));
    ticks = kz_output.action == KZ_ACTION_NONE ? 0 : act();
  }
}

// No source of this interrupt is ever switched on: memory or the chip is damaged. The watchdog
// resets.
KZ_INTERRUPT void kz_unexpected(void) {
  kz_pins_off();
  for (;;) continue;
}
