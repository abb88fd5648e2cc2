// Logs in flash, of the calibration and of the address: what is valid there, what to write next.
// SPDX-License-Identifier: Apache-2.0
//
// A block of flash is a log of lines, written one after the other and erased only as a whole. So
// many lines in a row as a copy has parts, all of one sequence number, are a copy; the newest whole
// one counts. With two blocks a block is only erased while the other one holds the newest copy:
// whenever power is lost, the old copy or the new one is there.
//
// Everything works on images of the blocks, and so runs on the PC too. Who really writes: the
// firmware (firmware/memory.c) and the native engine.
//
// A line, big-endian: u16 sequence, u8 part, u8 erases of its block, 24 bytes of data, u8 erases of
// the other block (so that the count outlives an erasure that power ended), u8 0xFF, and u16 kz_crc16
// (start 0xFFFF) of the 30 bytes before.
#ifndef KAZ_SHARED_SERVO_STORE_H
#define KAZ_SHARED_SERVO_STORE_H

#include "shared/base/types.h"
#include "shared/board/board.h"
#include "shared/servo/snapshot.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_STORE_LINE 32   // bytes: what the flash programs at once
#define KZ_STORE_LINES 32  // of a block
#define KZ_STORE_BLOCK (KZ_STORE_LINE * KZ_STORE_LINES)
#define KZ_STORE_DATA 24        // bytes of a line that are its user's
#define KZ_STORE_ENDURANCE 100  // guaranteed erasures of a block

#define KZ_CALIBRATION_BLOCKS 2
#define KZ_CALIBRATION_PARTS 3  // lines of a copy, 6 joints each
#define KZ_ADDRESS_BLOCKS 1
#define KZ_ADDRESS_PARTS 1

// Contents of a log.
typedef struct kz_store {
  u16 sequence;  // of the newest copy; 0: there is none
  u16 last;      // newest number of any valid line, of copies or not; 0: there is none
  u8 blocks;     // 1 or 2
  u8 parts;      // lines of a copy
  u8 block;      // of the newest copy, 0 if there is none
  u8 line;       // its first line
  u8 used[2];    // lines of each block up to the last that is not blank
  u8 erases[2];  // how often each block has been erased, at most 255
} kz_store;

// Where the next copy goes.
typedef struct kz_store_plan {
  u16 sequence;  // 1..65535
  u8 block;
  u8 line;   // its first line
  u8 erase;  // the block is to be erased first
} kz_store_plan;

// Reads a log of `parts` lines a copy in the images of its one or two blocks, 1 KB each.
void kz_store_scan(kz_store* store, const u8* const* images, u8 blocks, u8 parts);

// Behind the newest copy if its block has room, else at the start of the other block, which is
// erased. A log of one block is erased when it is full, and holds no copy until the new one is written.
void kz_store_plan_next(const kz_store* store, kz_store_plan* plan);

// Line number `part` of the copy: 32 bytes to be programmed at line plan->line + part.
void kz_store_encode(u8* line, const kz_store* store, const kz_store_plan* plan, u8 part,
                     const u8* data);

// The data of a part of the newest copy. Only if there is one.
const u8* kz_store_data(const kz_store* store, const u8* const* images, u8 part);

// Calibration of joints 6 part .. 6 part + 5 as data of a line.
void kz_store_pack_calibration(u8* data, u8 part, const s16* centre, const s16* scale);

// Puts into `startup` what the logs hold: calibration, address, shared_line. What is not there, or
// makes no sense, stays as it is (kz_startup_nominal).
void kz_store_load_calibration(const kz_store* store, const u8* const* images, kz_startup* startup);
void kz_store_pack_address(u8* data, u8 address, u8 shared_line);
void kz_store_load_address(const kz_store* store, const u8* const* images, kz_startup* startup);

#ifdef __cplusplus
}
#endif

#endif
