// Inputs and outputs of the servo tick, and what the board knows before the first tick.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SNAPSHOT_H
#define KAZ_SHARED_SERVO_SNAPSHOT_H

#include "shared/base/types.h"
#include "shared/board/board.h"
#include "shared/protocol/frame.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_RX_PER_TICK 16  // bytes taken from the wire in one tick, at most
#define KZ_TX_PER_TICK 16  // bytes given to the wire in one tick, at most

// Why the CPU last started.
#define KZ_RESET_POWER 0
#define KZ_RESET_WATCHDOG 1
#define KZ_RESET_COMMAND 2

// Actions between two ticks, requested by a tick. Only while all motors are off.
#define KZ_ACTION_NONE 0
#define KZ_ACTION_STORE_CALIBRATION 1  // pot_centre and pot_scale of the joints, to flash
#define KZ_ACTION_STORE_ADDRESS 2      // new_address and new_shared_line, to flash
#define KZ_ACTION_RESET 3
#define KZ_ACTION_LOADER 4

// The loader starts the application again after this time.
#define KZ_LOADER_S 3

// Result of the action.
#define KZ_RESULT_NONE 0  // no action in the last tick
#define KZ_RESULT_DONE 1
#define KZ_RESULT_FAILED 2

// Size of the transmit buffer, bytes.
#define KZ_TX_BUFFER 63

// What the board knows before its first tick.
typedef struct kz_startup {
  u16 image_crc;      // CRC of the flash image
  u16 start_8states;  // how long the start took, in units of 8 states
  u8 reset_cause;     // KZ_RESET_*
  u8 tests_done;      // KZ_TEST_*
  u8 tests_failed;    // KZ_TEST_*
  u8 address;         // 1..14, of the id block in flash; KZ_ADDRESS_DEFAULT if that is empty
  u8 shared_line;     // other boards are on the line
  u8 calibration;     // KZ_CALIBRATION_*
  s16 pot_centre[KZ_JOINTS];  // as stored; nominal where nothing valid is
  s16 pot_scale[KZ_JOINTS];
} kz_startup;

typedef struct kz_tick_input {
  u32 tick;                  // number of this tick since reset
  u16 busy_8states;          // length of the previous tick, in units of 8 states
  u16 worst_8states;         // longest tick so far, in units of 8 states
  u16 missed;                // ticks missed since the previous one
  u16 calibration_sequence;  // number of the copy in flash, 0 if none is valid
  u16 analog[KZ_ANALOG];     // A/D codes 0..1023, by multiplexer * 8 + input
  u8 erases_a;               // how often calibration block A has been erased
  u8 erases_b;               // the same of block B
  u8 result;                 // KZ_RESULT_* of the action that the previous tick requested
  u8 tx_room;                // bytes that the transmit buffer can take, 0..KZ_TX_BUFFER
  u8 rx_count;               // bytes in rx, 0..KZ_RX_PER_TICK
  u8 rx[KZ_RX_PER_TICK];
  u8 rx_flags[KZ_RX_PER_TICK];  // KZ_RX_* of each byte, 0 if valid
  u8 spare;                     // the size is even
} kz_tick_input;

// What goes to the pins and to the serial line at the start of the next tick.
typedef struct kz_tick_output {
  u8 pw[16];  // PWDR0..15: high counts out of 256
  u8 tmo[2];  // the same for TMO0, TMO1
  u8 p3;      // port data: direction bits (joints.def), other bits 0
  u8 p4;  // direction bits and KZ_P4_ENABLE; the multiplexer bits are 0 here, the A/D driver adds
          // them
  u8 p5;
  u8 p6;
  u8 action;    // KZ_ACTION_*, done before the next tick
  u8 tx_count;  // bytes in tx, 0..KZ_TX_PER_TICK, never more than tx_room
  u8 tx[KZ_TX_PER_TICK];
} kz_tick_output;

#ifdef __cplusplus
}
#endif

#endif
