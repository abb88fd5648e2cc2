// Serial line to the host: SCI0 at 115,200 baud, 8N1, interrupt-driven.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_SERIAL_H
#define KAZ_FIRMWARE_SERIAL_H

#include "shared/servo/snapshot.h"

// Initializes SCI0 with interrupts. On a shared line the transmitter is off while nothing is sent, and TxD
// then floats.
void kz_serial_init(u8 shared_line);
// Returns 1 once the stop bit of the last byte has been sent.
u8 kz_serial_idle(void);
// Queues bytes for sending. `count` must be at most kz_serial_room().
void kz_serial_send(const u8* bytes, u8 count);
// Returns the number of free bytes in the transmit buffer.
u8 kz_serial_room(void);
// Moves up to KZ_RX_PER_TICK received bytes and their error flags (KZ_RX_*) to `input`. Elements of rx with
// index rx_count or more keep their old content.
void kz_serial_take(kz_tick_input* input);

#endif
