// How a host and the flash writer talk: the program in the board's RAM that boot mode or the resident
// loader starts.
// SPDX-License-Identifier: Apache-2.0
//
// A frame, both ways: SYNC, type, length of the payload (2 bytes), number, check (the complement of the
// sum of the four bytes before it), payload, CRC-16 (shared/protocol/crc16.h: 0x1021, start 0xFFFF) over
// everything from the type to the end of the payload. Numbers of more than one byte are big-endian.
// A reply has the request's number and its type | REPLY; its payload begins with a status and a byte
// without meaning. Each
// request may be repeated: it says what is to be, not what is to be added.
#ifndef KAZ_SHARED_FLASH_PROTOCOL_H
#define KAZ_SHARED_FLASH_PROTOCOL_H

#define KZ_WRITER_PROTOCOL 1
#define KZ_WRITER_SYNC 0x4B
#define KZ_WRITER_HEADER 6    // bytes in front of the payload
#define KZ_WRITER_OVERHEAD 8  // header and CRC
#define KZ_WRITER_REPLY 0x80

#define KZ_WRITER_DATA_MAX 512  // of one WRITE or READ
#define KZ_WRITER_PAYLOAD_MAX (KZ_WRITER_DATA_MAX + 4)
#define KZ_WRITER_FRAME_MAX (KZ_WRITER_PAYLOAD_MAX + KZ_WRITER_OVERHEAD)
// Maximum number of outstanding requests: the writer receives one while it works on another.
#define KZ_WRITER_WINDOW 2

// Requests: payload -> what follows the status in the reply
// -> protocol, 1 if started by the loader, board id (2; FFFF: unknown)
#define KZ_WRITER_INFO 1
// BRR (1), of the bounds below; takes effect behind the reply
#define KZ_WRITER_RATE 2
#define KZ_WRITER_BRR_MIN 4    // 115,200 baud
#define KZ_WRITER_BRR_MAX 119  // 4,800 baud
// block (1), 0..9
#define KZ_WRITER_ERASE 3
// address (4), data: whole lines of 32 bytes -> low half of the address of the line that failed, or of
// the end (2).
// To flash: only within it; nothing is written of a request that reaches beyond.
// To RAM (the upper half of the address is 00FF): after boot mode the second stage of the writer, in
// order, without gaps and not past its end. Bytes that are there already are compared, not stored, so a
// repeated request is OK and nothing changes code that may run. A writer that the loader started
// refuses every write to RAM. In a reply from RAM the low half is that of the request.
#define KZ_WRITER_WRITE 4
// address (4), length (4) -> CRC-16, sum, sum of sums (2 each)
#define KZ_WRITER_SUM 5
// address (4), length (2) -> data
#define KZ_WRITER_READ 6
// leaves through the reset vector behind the reply
#define KZ_WRITER_RUN 7

// Statuses
#define KZ_WRITER_OK 0
#define KZ_WRITER_DAMAGED 1  // a frame came damaged; number 0
#define KZ_WRITER_UNKNOWN 2  // there is no such request
// Out of range, not on a line's bounds, or a payload of another length; in RAM a gap would be left.
#define KZ_WRITER_ARGUMENTS 3
// For a writer that the loader started: the loader's and the vectors' block, and all RAM. After boot
// mode: RAM outside of the second stage, and inside where other bytes stand.
#define KZ_WRITER_PROTECTED 4
#define KZ_WRITER_NOT_ERASED 5   // cells are still programmed after all pulses
#define KZ_WRITER_NOT_WRITTEN 6  // cells do not take their value after all pulses
#define KZ_WRITER_NOT_BLANK 7    // other data stand there: erase first
#define KZ_WRITER_LOCKED 8       // the chip's error protection is on until reset
#define KZ_WRITER_NOTHING 9      // RUN: the reset vector is blank

#endif
