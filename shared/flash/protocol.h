// Protocol between a host and the flash writer.
// The flash writer is a program in the board's RAM. Boot mode or the resident loader starts it.
// SPDX-License-Identifier: Apache-2.0
//
// A frame in either direction; numbers are big-endian:
//   sync     KZ_WRITER_SYNC
//   type     1 byte
//   length   size of the payload, 2 bytes
//   number   1 byte
//   check    complement of the sum of the four bytes from type to number
//   payload
//   CRC-16   from the type to the end of the payload (shared/protocol/crc16.h: 0x1021, start 0xFFFF)
//
// A reply has the request's number and its type | KZ_WRITER_REPLY. The reply's payload begins with a status
// and an unused byte. All requests are idempotent, so a host may repeat any of them.
#ifndef KAZ_SHARED_FLASH_PROTOCOL_H
#define KAZ_SHARED_FLASH_PROTOCOL_H

#define KZ_WRITER_PROTOCOL 1
#define KZ_WRITER_SYNC 0x4B
#define KZ_WRITER_HEADER 6    // bytes before the payload
#define KZ_WRITER_OVERHEAD 8  // header and CRC
#define KZ_WRITER_REPLY 0x80

#define KZ_WRITER_DATA_MAX 512  // maximum data of one WRITE or READ, bytes
#define KZ_WRITER_PAYLOAD_MAX (KZ_WRITER_DATA_MAX + 4)
#define KZ_WRITER_FRAME_MAX (KZ_WRITER_PAYLOAD_MAX + KZ_WRITER_OVERHEAD)
// Maximum number of outstanding requests: the writer receives one request while it executes another.
#define KZ_WRITER_WINDOW 2

// Requests. The comments state: payload of the request -> payload of the reply after status and unused byte.
// Sizes in brackets are in bytes. -> protocol (1), 1 if started by the loader (1), board id (2; FFFF:
// unknown)
#define KZ_WRITER_INFO 1
// BRR (1), within the bounds below; takes effect after the reply
#define KZ_WRITER_RATE 2
#define KZ_WRITER_BRR_MIN 4    // 115,200 baud
#define KZ_WRITER_BRR_MAX 119  // 4,800 baud
// block (1), 0..9
#define KZ_WRITER_ERASE 3
// address (4), data: whole lines of 32 bytes
//   -> low half of the address (2): address of the first line that failed, or of the end
//
// Writes to flash: a request that reaches beyond the end of flash writes nothing. Writes to RAM (upper half
// of the address is 00FF): allowed only to load the writer's second stage after boot mode, in order and
// without gaps. Bytes below the end of the loaded part are compared and not stored. So a repeated request
// succeeds, and code that may be running never changes. A writer that the loader started refuses every write
// to RAM. The reply contains the low half of the request's address.
#define KZ_WRITER_WRITE 4
// address (4), length (4) -> CRC-16, sum, sum of sums (2 each)
#define KZ_WRITER_SUM 5
// address (4), length (2) -> data
#define KZ_WRITER_READ 6
// starts the program at the reset vector after the reply
#define KZ_WRITER_RUN 7

// Status codes
#define KZ_WRITER_OK 0
#define KZ_WRITER_DAMAGED 1  // a frame was damaged; the reply's number is 0
#define KZ_WRITER_UNKNOWN 2  // unknown request
// Value out of range, address or size not a multiple of a line, wrong length of the payload, or gap in RAM.
#define KZ_WRITER_ARGUMENTS 3
// The memory is protected. A writer that the loader started protects the blocks of vectors and loader, and
// all RAM. After boot mode, the writer protects RAM outside the second stage, and refuses different bytes in
// the loaded part of the second stage.
#define KZ_WRITER_PROTECTED 4
#define KZ_WRITER_NOT_ERASED 5   // cells are still programmed after the maximum number of pulses
#define KZ_WRITER_NOT_WRITTEN 6  // cells have a wrong value after the maximum number of pulses
#define KZ_WRITER_NOT_BLANK 7    // the line holds other data; erase it first
#define KZ_WRITER_LOCKED 8       // the chip's error protection is active until reset
#define KZ_WRITER_NOTHING 9      // RUN: the reset vector is blank

#endif
