// The flash writer: the program in RAM that boot mode or the loader starts (shared/flash/protocol.h).
// SPDX-License-Identifier: Apache-2.0
//
// It calls nothing and reads nothing in flash but what the host requests. No interrupt can be used: their
// vectors are in flash. So every wait polls the receiver, and a frame comes in while another is
// programmed. At 115,200 baud a byte has to be taken every 87 us at least.
//
// Boot mode takes 2048 bytes: the line and programming (writer.c, writer_flash.c). With them the host
// writes the rest into RAM (writer_second_stage.c: erasing, sums, reading, leaving), twelve times as fast.
#ifndef KAZ_FIRMWARE_WRITER_H
#define KAZ_FIRMWARE_WRITER_H

#include "shared/base/types.h"
#include "shared/flash/protocol.h"

// Bytes stand in the short RAM, where an access is one word of code, the rest where it is two.
#define SHORT __attribute__((eightbit_data))
#define NEAR __attribute__((tiny_data))

#define KZ_WRITER_BLOCKS 10
#define KZ_WRITER_LINE 32  // bytes
#define KZ_FLASH_BYTES 0x20000UL

typedef struct {
  u8 sync;
  u8 type;
  u16 length;  // of the payload
  u8 number;
  u8 check;
  u8 payload[KZ_WRITER_PAYLOAD_MAX + 2];  // and the CRC
} frame;

extern u16 kz_writer_crc NEAR;
extern volatile u8 kz_writer_by_loader SHORT;
extern volatile u8 kz_writer_heard SHORT;
extern u16 kz_writer_silent NEAR;  // overflows of the timer since the last whole frame

// Takes a byte if one has come.
void kz_writer_poll(void);
// Polls for so many counts of 8 states.
void kz_writer_wait(u16 counts);
#define KZ_COUNTS(us) ((u16)((us)*2304UL / 1000 + 1))
// Into the CRC; polls.
void kz_writer_count(u8 byte);
// The request becomes the reply: `bytes` of payload, the status among them.
void kz_writer_reply(frame* it, u16 bytes);

// --- writer_flash.c: returns a KZ_WRITER_ status; the line has to be on a line's bound.
u8 kz_writer_program(u32 address, const u16* line);
void kz_writer_set_flash(u8 bits);  // of FLMCR1 besides SWE, and waits until they act
u8 kz_writer_end_flash(u8 status);
void kz_writer_pulse(u8 setup, u16 setup_counts, u8 on, u16 counts);
u16 kz_writer_verified_word(volatile u16* at);

// --- writer_second_stage.c
void kz_writer_perform(frame* it);
void kz_writer_wait_for(u16 seconds);
void kz_writer_idle(void);

void kz_writer_leave(void);  // writer_start.S: through the reset vector

#endif
