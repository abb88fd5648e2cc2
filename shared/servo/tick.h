// The servo tick: all that the board computes each millisecond, from snapshot and state alone.
// SPDX-License-Identifier: Apache-2.0
//
// Equal sequences of kz_tick_input give equal sequences of kz_tick_output and equal state, on the
// H8S/2128 and on the PC (design, section 3). So nothing here reads a register, a clock or memory
// it does not own: whatever is measured (how long the last tick took, the CRC of the image) comes
// in through the snapshot.
#ifndef KAZ_SHARED_SERVO_TICK_H
#define KAZ_SHARED_SERVO_TICK_H

#include "shared/base/types.h"
#include "shared/board/board.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_RX_PER_TICK 16  // bytes taken from the wire in one tick, at most
#define KZ_TX_PER_TICK 16  // bytes given to the wire in one tick, at most

// Error flags of a received byte, as the SCI reports them.
#define KZ_RX_OVERRUN 0x20
#define KZ_RX_FRAMING 0x10
#define KZ_RX_PARITY 0x08
#define KZ_RX_LOST 0x04  // the receive buffer was full: bytes before this one are gone

// Why the CPU last started.
#define KZ_RESET_POWER 0
#define KZ_RESET_WATCHDOG 1
#define KZ_RESET_COMMAND 2

typedef struct kz_tick_input {
  u32 tick;               // number of this tick since reset
  u16 busy_8states;       // length of the previous tick, in units of 8 states
  u16 worst_8states;      // longest tick so far, in units of 8 states
  u16 image_crc;          // CRC of the flash image, computed at start
  u16 analog[KZ_ANALOG];  // A/D codes 0..1023, by multiplexer * 8 + input
  u8 missed;              // ticks missed since the previous one
  u8 reset_cause;         // KZ_RESET_*
  u8 tx_room;             // bytes that the transmit buffer can take, at most 255
  u8 rx_count;            // bytes in rx, 0..KZ_RX_PER_TICK
  u8 rx[KZ_RX_PER_TICK];
  u8 rx_flags[KZ_RX_PER_TICK];  // KZ_RX_* of each byte, 0 if sound
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
  u8 tx_count;  // bytes in tx, 0..KZ_TX_PER_TICK, never more than tx_room
  u8 tx[KZ_TX_PER_TICK];
} kz_tick_output;

struct kz_servo;

// Brings the state to that after reset: motors off, nothing received. Writes the outputs for it.
void kz_servo_init(struct kz_servo* servo, kz_tick_output* output);

// One tick. `output` is written whole. Motors are off (enable bit 0, all duties 0) until the host
// enables a joint, and again after any fault.
void kz_tick(struct kz_servo* servo, const kz_tick_input* input, kz_tick_output* output);

#ifdef __cplusplus
}
#endif

#endif
