// The host line: SCI0 at 115,200 baud, 8N1, interrupt-driven.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_SERIAL_H
#define KAZ_FIRMWARE_SERIAL_H

#include "shared/servo/snapshot.h"

// On a shared line the transmitter is off, and TxD floats, while there is nothing to send.
void kz_serial_init(u8 shared_line);
// The last byte's stop bit has left.
u8 kz_serial_idle(void);
// Queues the bytes of a tick's output; the caller kept to kz_serial_room().
void kz_serial_send(const u8* bytes, u8 count);
// Bytes that kz_serial_send can take.
u8 kz_serial_room(void);
// Moves at most KZ_RX_PER_TICK received bytes with their error flags (KZ_RX_*) to the snapshot;
// behind rx_count old ones stay.
void kz_serial_take(kz_tick_input* input);

#endif
