// Flash writer: the program in RAM that boot mode or the loader starts (shared/flash/protocol.h).
// SPDX-License-Identifier: Apache-2.0
//
// The writer calls no code in flash, and reads flash only at the host's request. Interrupts are off, because
// the interrupt vectors are in flash. Therefore every wait loop polls the receiver. So a frame can arrive
// while the writer programs a flash line from an earlier frame. At 115,200 baud the receiver must be read at
// least every 87 us.
//
// Boot mode loads 2048 bytes with the code for the serial line and for programming (writer.c,
// writer_flash.c). This code then receives the second stage (writer_second_stage.c: erase, sums, read, run).
// The transfer is twelve times as fast as a transfer in boot mode.
#ifndef KAZ_FIRMWARE_WRITER_H
#define KAZ_FIRMWARE_WRITER_H

#include "shared/base/types.h"
#include "shared/flash/protocol.h"

// Memory areas of variables. An instruction that accesses a SHORT byte is one word long. An instruction that
// accesses a NEAR variable is two words long.
#define SHORT __attribute__((eightbit_data))
#define NEAR __attribute__((tiny_data))

#define KZ_WRITER_BLOCKS 10  // number of erase blocks
#define KZ_WRITER_LINE 32    // bytes
#define KZ_FLASH_BYTES 0x20000UL

typedef struct {
  u8 sync;
  u8 type;
  u16 length;  // size of the payload, bytes
  u8 number;
  u8 check;
  u8 payload[KZ_WRITER_PAYLOAD_MAX + 2];  // payload and CRC
} frame;

extern u16 kz_writer_crc NEAR;                 // CRC of the received part of the present frame
extern volatile u8 kz_writer_by_loader SHORT;  // 1: the loader started the writer
extern volatile u8 kz_writer_heard SHORT;      // 1: a valid request has arrived
// Number of timer overflows since the last valid request.
extern u16 kz_writer_silent NEAR;

// Reads a received byte, if any, into the present frame.
void kz_writer_poll(void);
// Waits for `counts` times 8 states, and polls the receiver while waiting.
void kz_writer_wait(u16 counts);
#define KZ_COUNTS(us) ((u16)((us)*2304UL / 1000 + 1))
// Adds a byte to the CRC and polls the receiver.
void kz_writer_count(u8 byte);
// Turns the request `it` into the reply and sends the reply. `bytes` is the size of the reply's payload,
// including the status. Polls the receiver while sending.
void kz_writer_reply(frame* it, u16 bytes);

// --- writer_flash.c

// Programs a line of KZ_WRITER_LINE bytes at `address`, a multiple of KZ_WRITER_LINE. Returns a KZ_WRITER_
// status.
u8 kz_writer_program(u32 address, const u16* line);
// Sets `bits` in FLMCR1 in addition to SWE, and waits until these bits take effect.
void kz_writer_set_flash(u8 bits);
// Ends access to flash. Returns `status`, or KZ_WRITER_LOCKED after an error of the chip.
u8 kz_writer_end_flash(u8 status);
// Applies one pulse: sets the bit `setup` of FLMCR2, then the bit `on` of FLMCR1. `setup_counts` and `counts`
// are the durations of these two steps.
void kz_writer_pulse(u8 setup, u16 setup_counts, u8 on, u16 counts);
// Reads a word in verify mode.
u16 kz_writer_verified_word(volatile u16* at);

// --- writer_second_stage.c

// Executes a request of the second stage and replies.
void kz_writer_perform(frame* it);
// Sets the timeout of the writer; 0: no timeout. The writer ends if no request arrives within the timeout.
// The timeout applies only to a writer that the loader started.
void kz_writer_wait_for(u16 seconds);
// Counts timer overflows. Ends the writer after the timeout.
void kz_writer_idle(void);

// Ends the writer: jumps through the reset vector (writer_start.S).
void kz_writer_leave(void);

#endif
