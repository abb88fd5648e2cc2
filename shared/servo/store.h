// Log-structured storage of calibration and address in flash: finds the valid copy and plans the next one.
// SPDX-License-Identifier: Apache-2.0
//
// A log consists of one or two blocks of flash. The lines of a block are written in order; all lines of a
// block are erased together. A copy of the settings has one line per part. The lines of a copy are
// consecutive and share one sequence number. The newest complete copy is the valid copy. If the log has two
// blocks, a block is erased only while the other block contains the newest copy. So after a power loss at any
// time, the old or the new copy is valid.
//
// The functions work on memory images of the blocks, so they also run on the PC. firmware/memory.c and the
// native engine write the lines.
//
// Layout of a line, big-endian:
//   u16  sequence number
//   u8   part
//   u8   number of erasures of the line's block
//   24 bytes of data
//   u8   number of erasures of the other block (not lost if power fails while erasing that block)
//   u8   0xFF
//   u16  kz_crc16 (start 0xFFFF) of the 30 bytes before
#ifndef KAZ_SHARED_SERVO_STORE_H
#define KAZ_SHARED_SERVO_STORE_H

#include "shared/base/types.h"
#include "shared/board/board.h"
#include "shared/servo/snapshot.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_STORE_LINE 32   // bytes per line; the flash programs a whole line at once
#define KZ_STORE_LINES 32  // lines per block
#define KZ_STORE_BLOCK (KZ_STORE_LINE * KZ_STORE_LINES)
#define KZ_STORE_DATA 24        // bytes of user data per line
#define KZ_STORE_ENDURANCE 100  // number of erasures that the chip guarantees for a block

#define KZ_CALIBRATION_BLOCKS 2
#define KZ_CALIBRATION_PARTS 3  // lines per copy, 6 joints each
#define KZ_ADDRESS_BLOCKS 1
#define KZ_ADDRESS_PARTS 1

// Contents of a log, as found by kz_store_scan.
typedef struct kz_store {
  u16 sequence;  // sequence number of the newest copy; 0: no copy
  // Newest sequence number of all valid lines, including the lines of incomplete copies; 0: no valid line.
  u16 last;
  u8 blocks;     // 1 or 2
  u8 parts;      // lines per copy
  u8 block;      // block of the newest copy, 0 if there is no copy
  u8 line;       // first line of the newest copy
  u8 used[2];    // number of lines of each block from line 0 to the last line that is not blank
  u8 erases[2];  // number of erasures of each block, saturated at 255
} kz_store;

// Destination of the next copy.
typedef struct kz_store_plan {
  u16 sequence;  // 1..65535
  u8 block;
  u8 line;   // first line of the copy
  u8 erase;  // 1: erase the block first
} kz_store_plan;

// Scans a log with `parts` lines per copy. `images` points to the blocks of the log, each 1 KB. `blocks` is
// the number of blocks, 1 or 2.
void kz_store_scan(kz_store* store, const u8* const* images, u8 blocks, u8 parts);

// Plans the next copy. If the block with the newest copy has enough free lines, the next copy goes to these
// lines. Otherwise the next copy goes to the beginning of the other block, which must be erased first. If the
// log has only one block, this block must be erased when it is full. From the erasure until the new copy is
// written, the log then has no valid copy.
void kz_store_plan_next(const kz_store* store, kz_store_plan* plan);

// Writes one part of the planned copy to `line` (32 bytes). The caller must then program these 32 bytes into
// a line of the block plan->block. The number of this line is: plan->line + part. `data` has KZ_STORE_DATA
// bytes.
void kz_store_encode(u8* line, const kz_store* store, const kz_store_plan* plan, u8 part,
                     const u8* data);

// Returns a pointer to the data in line `part` of the newest copy. The data has KZ_STORE_DATA bytes and is in
// `images`. Requires sequence != 0.
const u8* kz_store_data(const kz_store* store, const u8* const* images, u8 part);

// Writes the calibration of six joints to the KZ_STORE_DATA bytes of `data`. The first of these joints has
// the number `6 * part`. `centre` and `scale` have KZ_JOINTS elements each.
void kz_store_pack_calibration(u8* data, u8 part, const s16* centre, const s16* scale);

// kz_store_load_calibration copies the stored calibration to `startup`; kz_store_load_address copies the
// stored address and shared_line. If the log has no valid copy, kz_store_load_calibration and
// kz_store_load_address do not change `startup`. If the stored address or the stored shared_line is invalid,
// kz_store_load_address does not change `startup`.
void kz_store_load_calibration(const kz_store* store, const u8* const* images, kz_startup* startup);
void kz_store_pack_address(u8* data, u8 address, u8 shared_line);
void kz_store_load_address(const kz_store* store, const u8* const* images, kz_startup* startup);

#ifdef __cplusplus
}
#endif

#endif
