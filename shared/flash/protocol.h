// Protocol between a host and the flash writer. The flash writer is a program in the board's RAM. Boot mode
// or the resident loader starts the flash writer.
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
// A reply has the same number as its request. The type of a reply is the type of the request, with the bit
// KZ_WRITER_REPLY set. The reply's payload begins with a status and an unused byte. All requests are
// idempotent, so a host may repeat any request.
#ifndef KAZ_SHARED_FLASH_PROTOCOL_H
#define KAZ_SHARED_FLASH_PROTOCOL_H

#define KZ_WRITER_PROTOCOL 1
#define KZ_WRITER_SYNC 0x4B
#define KZ_WRITER_HEADER 6    // bytes before the payload
#define KZ_WRITER_OVERHEAD 8  // header and CRC
#define KZ_WRITER_REPLY 0x80

#define KZ_WRITER_DATA_MAX 512  // maximum data of a WRITE or READ, bytes
#define KZ_WRITER_PAYLOAD_MAX (KZ_WRITER_DATA_MAX + 4)
#define KZ_WRITER_FRAME_MAX (KZ_WRITER_PAYLOAD_MAX + KZ_WRITER_OVERHEAD)
// Maximum number of outstanding requests. The writer executes one request and meanwhile receives another.
#define KZ_WRITER_WINDOW 2

// Requests. The comment on each request describes the payload of the request and the payload of the reply. In
// a reply, these bytes follow the status and an unused byte. Numbers in brackets are sizes in bytes.
//
// INFO: the request is empty. The reply has the protocol version (1), a flag (1), and the board id (2). The
// flag is 1 if the loader started the writer, otherwise 0. The board id FFFF means that the id is unknown.
#define KZ_WRITER_INFO 1
// RATE: the request has the new value of the register BRR (1). The new rate takes effect after the reply.
#define KZ_WRITER_RATE 2
#define KZ_WRITER_BRR_MIN 4    // 115,200 baud
#define KZ_WRITER_BRR_MAX 119  // 4,800 baud
// ERASE: the request has the number of the block (1), 0..9.
#define KZ_WRITER_ERASE 3
// WRITE: the request has an address (4) and data (whole lines of 32 bytes). The reply has the lower 16 bits
// of an address (2). If a line fails, the writer stops, and the reply has the address of this line. If all
// lines succeed, the reply has the address of the byte after the data.
//
// If the data of a WRITE extend beyond the end of flash, the writer writes nothing.
//
// A WRITE to RAM has an address from 00FF0000 to 00FFFFFF. After boot mode, the host loads the writer's
// second stage by writes to RAM, in order and without gaps. Writes to RAM have no other use. Bytes that are
// already loaded are never overwritten: the writer only compares them with the received bytes. So a repeated
// request succeeds, and running code never changes. A writer that the loader started refuses every write to
// RAM. The reply to a write to RAM has the low half of the request's address.
#define KZ_WRITER_WRITE 4
// SUM: the request has address (4) and length (4). The reply has CRC-16 (2), sum (2) and sum of sums (2).
#define KZ_WRITER_SUM 5
// READ: the request has address (4) and length (2). The reply has the data.
#define KZ_WRITER_READ 6
// RUN: after the reply, the writer starts the program at the reset vector.
#define KZ_WRITER_RUN 7

// Status codes
#define KZ_WRITER_OK 0
#define KZ_WRITER_DAMAGED 1  // a frame was damaged; the reply's number is 0
#define KZ_WRITER_UNKNOWN 2  // unknown request
// The arguments of the request are wrong: a value is out of range, or the payload has a wrong length. The
// arguments of a WRITE are also wrong if the address or the size of the data is not a multiple of 32 bytes.
// The address of a WRITE to RAM is wrong if it leaves a gap after the bytes that are already loaded.
#define KZ_WRITER_ARGUMENTS 3
// The memory is protected. A writer that the loader started protects the blocks of vectors and loader, and
// all RAM. After boot mode, the writer protects RAM outside the second stage. If a WRITE would change bytes
// of the second stage that are already loaded, the writer refuses the WRITE.
#define KZ_WRITER_PROTECTED 4
#define KZ_WRITER_NOT_ERASED 5   // some cells are not erased after the maximum number of pulses
#define KZ_WRITER_NOT_WRITTEN 6  // cells have a wrong value after the maximum number of pulses
#define KZ_WRITER_NOT_BLANK 7    // the line contains other data; erase the block first
#define KZ_WRITER_LOCKED 8       // the chip's error protection is active until reset
#define KZ_WRITER_NOTHING 9      // RUN: there is no program, because the reset vector is blank

#endif
