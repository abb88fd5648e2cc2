// Flash writer: the program in RAM that boot mode or the loader starts (shared/flash/protocol.h).
// SPDX-License-Identifier: Apache-2.0
//
// The writer calls no code in flash, and reads flash only at the host's request. Interrupts are off, because
// their vectors are in flash. So every wait loop polls the receiver, and a frame can arrive while the line
// of another frame is programmed. At 115,200 baud the receiver must be read at least every 87 us.
//
// Boot mode loads 2048 bytes with the code for the serial line and for programming (writer.c,
// writer_flash.c). Through this code, the host loads the second stage (writer_second_stage.c: erase, sums,
// read, run), twelve times as fast as through boot mode.
#ifndef KAZ_FIRMWARE_WRITER_H
#define KAZ_FIRMWARE_WRITER_H

#include "shared/base/types.h"
#include "shared/flash/protocol.h"

// Memory areas of variables. An instruction that accesses a SHORT byte is one word long; for a NEAR
// variable, two words.
#define SHORT __attribute__((eightbit_data))
#define NEAR __attribute__((tiny_data))

#define KZ_WRITER_BLOCKS 10  // erase blocks
#define KZ_WRITER_LINE 32    // bytes
#define KZ_FLASH_BYTES 0x20000UL

typedef struct {
  u8 sync;
  u8 type;
  u16 length;  // size of the payload, bytes
  u8 number;
  u8 check;
  u8 payload[KZ_WRITER_PAYLOAD_MAX + 2];  // with the CRC
} frame;

extern u16 kz_writer_crc NEAR;                 // CRC of the present frame so far
extern volatile u8 kz_writer_by_loader SHORT;  // 1: started by the loader
extern volatile u8 kz_writer_heard SHORT;      // 1: a valid request has arrived
extern u16 kz_writer_silent NEAR;              // timer overflows since the last valid request

// Reads a received byte, if any, into the present frame.
void kz_writer_poll(void);
// Waits for `counts` times 8 states and polls meanwhile.
void kz_writer_wait(u16 counts);
#define KZ_COUNTS(us) ((u16)((us)*2304UL / 1000 + 1))
// Adds a byte to the CRC and polls.
void kz_writer_count(u8 byte);
// Turns the request `it` into the reply with `bytes` of payload, including the status, and sends the reply.
// Polls meanwhile.
void kz_writer_reply(frame* it, u16 bytes);

// --- writer_flash.c Programs a line of KZ_WRITER_LINE bytes at `address`, a multiple of KZ_WRITER_LINE.
// Returns a KZ_WRITER_ status.
u8 kz_writer_program(u32 address, const u16* line);
// Sets bits of FLMCR1 besides SWE, and waits until they take effect.
void kz_writer_set_flash(u8 bits);
// Ends access to flash. Returns `status`, or KZ_WRITER_LOCKED after an error of the chip.
u8 kz_writer_end_flash(u8 status);
// Applies one pulse: setup bit of FLMCR2, then pulse bit `on` of FLMCR1, with their times in counts.
void kz_writer_pulse(u8 setup, u16 setup_counts, u8 on, u16 counts);
// Reads a word in verify mode.
u16 kz_writer_verified_word(volatile u16* at);

// --- writer_second_stage.c
// Executes a request of the second stage and replies.
void kz_writer_perform(frame* it);
// Sets the timeout after which a writer that the loader started leaves, if no request has arrived; 0: no
// timeout.
void kz_writer_wait_for(u16 seconds);
// Counts timer overflows. Leaves after the timeout.
void kz_writer_idle(void);

// writer_start.S: jumps through the reset vector.
void kz_writer_leave(void);

#endif
