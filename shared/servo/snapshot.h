// Inputs and outputs of the servo tick, and the board's state before its first tick.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SNAPSHOT_H
#define KAZ_SHARED_SERVO_SNAPSHOT_H

#include "shared/base/types.h"
#include "shared/board/board.h"
#include "shared/protocol/frame.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_RX_PER_TICK 16  // maximum number of received bytes per tick
#define KZ_TX_PER_TICK 16  // maximum number of sent bytes per tick

// Cause of the CPU's last reset.
#define KZ_RESET_POWER 0
#define KZ_RESET_WATCHDOG 1
#define KZ_RESET_COMMAND 2

// Actions. A tick requests an action, which is then performed before the next tick. A tick requests an action
// only while all motors are off.
#define KZ_ACTION_NONE 0
#define KZ_ACTION_STORE_CALIBRATION 1  // writes pot_centre and pot_scale of the joints to flash
#define KZ_ACTION_STORE_ADDRESS 2      // writes new_address and new_shared_line to flash
#define KZ_ACTION_RESET 3
#define KZ_ACTION_LOADER 4

// Timeout, s, after which the loader starts the application again if no host sends a request.
#define KZ_LOADER_S 3

// Result of an action.
#define KZ_RESULT_NONE 0  // no action in the last tick
#define KZ_RESULT_DONE 1
#define KZ_RESULT_FAILED 2

// Size of the transmit buffer, bytes.
#define KZ_TX_BUFFER 63

// State of the board before its first tick: identity, self-tests, calibration.
typedef struct kz_startup {
  u16 image_crc;              // CRC of the application in flash
  u16 start_8states;          // duration of the board's start, in units of 8 states
  u8 reset_cause;             // KZ_RESET_*
  u8 tests_done;              // KZ_TEST_* flags
  u8 tests_failed;            // KZ_TEST_* flags
  u8 address;                 // 1..14, from flash; KZ_ADDRESS_DEFAULT if not stored
  u8 shared_line;             // 1: other boards are on the line
  u8 calibration;             // KZ_CALIBRATION_*
  s16 pot_centre[KZ_JOINTS];  // as stored in flash; nominal values if flash has no valid copy
  s16 pot_scale[KZ_JOINTS];
} kz_startup;

// Snapshot of all inputs at the start of a tick.
typedef struct kz_tick_input {
  u32 tick;                  // number of the tick since reset
  u16 busy_8states;          // length of the previous tick, in units of 8 states
  u16 worst_8states;         // longest tick so far, in units of 8 states
  u16 missed;                // number of ticks missed since the previous tick
  u16 calibration_sequence;  // sequence number of the valid copy in flash; 0: no valid copy
  u16 analog[KZ_ANALOG];     // A/D codes 0..1023; index: multiplexer * 8 + input
  u8 erases_a;               // number of erasures of calibration block A
  u8 erases_b;               // number of erasures of calibration block B
  u8 result;                 // KZ_RESULT_* of the action that the previous tick requested
  u8 tx_room;                // number of free bytes of the transmit buffer, 0..KZ_TX_BUFFER
  u8 rx_count;               // number of bytes in rx, 0..KZ_RX_PER_TICK
  u8 rx[KZ_RX_PER_TICK];
  u8 rx_flags[KZ_RX_PER_TICK];  // KZ_RX_* of each byte, 0 if valid
  u8 spare;                     // padding, makes the size even
} kz_tick_input;

// Outputs of a tick. The outputs are written to the pins and to the serial line at the start of the next
// tick.
typedef struct kz_tick_output {
  u8 pw[16];  // values of PWDR0..15; output i is high for pw[i] / 256 of each period
  u8 tmo[2];  // time for which the outputs TMO0 and TMO1 are high, in counts
  u8 p3;      // port data: direction bits (joints.def), other bits 0
  u8 p4;      // direction bits and KZ_P4_ENABLE; the A/D driver adds the multiplexer bits
  u8 p5;
  u8 p6;
  u8 action;    // KZ_ACTION_*, performed before the next tick
  u8 tx_count;  // number of bytes in tx; at most KZ_TX_PER_TICK, and at most tx_room
  u8 tx[KZ_TX_PER_TICK];
} kz_tick_output;

#ifdef __cplusplus
}
#endif

#endif
