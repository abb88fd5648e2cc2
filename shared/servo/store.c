// Logs in flash, of the calibration and of the address.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/store.h"

#include "shared/protocol/crc16.h"
#include "shared/protocol/messages.h"

// Where the fields of a line stand.
#define SEQUENCE 0
#define PART 2
#define ERASES 3
#define DATA 4
#define OTHER_ERASES 28
#define SPARE 29
#define CHECK 30

#define BLANK 0xFF
#define JOINTS_PER_LINE 6

static u16 read16(const u8* bytes) {
  return (u16)((u16)(bytes[0] << 8) | bytes[1]);
}

static void write16(u8* bytes, u16 value) {
  bytes[0] = (u8)(value >> 8);
  bytes[1] = (u8)value;
}

static u16 check_of(const u8* line) {
  u16 crc = 0xFFFF;
  u8 i;
  for (i = 0; i < CHECK; ++i) crc = kz_crc16_step(crc, line[i]);
  return crc;
}

static u8 is_blank(const u8* line) {
  u8 i;
  for (i = 0; i < KZ_STORE_LINE; ++i) {
    if (line[i] != BLANK) return 0;
  }
  return 1;
}

static u8 is_valid(const u8* line, u8 parts) {
  return (u8)(line[PART] < parts && read16(line + SEQUENCE) != 0 &&
              check_of(line) == read16(line + CHECK));
}

// Numbers go round; no log holds so many lines that half the circle would matter.
static u8 is_newer(u16 number, u16 than) {
  const u16 ahead = (u16)(number - than);
  return (u8)(than == 0 || (ahead != 0 && ahead < 0x8000));
}

static u8 larger(u8 a, u8 b) {
  return a > b ? a : b;
}

static void line_found(kz_store* store, const u8* line, u8 block) {
  const u8 other = (u8)(1 - block);
  const u16 number = read16(line + SEQUENCE);
  if (is_newer(number, store->last)) store->last = number;
  store->erases[block] = larger(store->erases[block], line[ERASES]);
  if (store->blocks == 2) store->erases[other] = larger(store->erases[other], line[OTHER_ERASES]);
}

static void scan_block(kz_store* store, const u8* line, u8 block) {
  u16 number = 0;  // of the last valid line
  u8 in_row = 0;   // valid lines of this number so far, with the parts 0, 1, ... in this order
  u8 i;
  for (i = 0; i < KZ_STORE_LINES; ++i, line += KZ_STORE_LINE) {
    if (is_blank(line)) {
      in_row = 0;
      continue;
    }
    store->used[block] = (u8)(i + 1);
    if (!is_valid(line, store->parts)) {
      in_row = 0;
      continue;
    }
    line_found(store, line, block);
    if (read16(line + SEQUENCE) != number || line[PART] != in_row) in_row = 0;
    number = read16(line + SEQUENCE);
    if (line[PART] != in_row) continue;
    ++in_row;
    if (in_row < store->parts) continue;
    in_row = 0;
    if (!is_newer(number, store->sequence)) continue;
    store->sequence = number;
    store->block = block;
    store->line = (u8)(i + 1 - store->parts);
  }
}

void kz_store_scan(kz_store* store, const u8* const* images, u8 blocks, u8 parts) {
  u8 block;
  store->sequence = 0;
  store->last = 0;
  store->blocks = blocks;
  store->parts = parts;
  store->block = 0;
  store->line = 0;
  for (block = 0; block < 2; ++block) {
    store->used[block] = 0;
    store->erases[block] = 0;
  }
  for (block = 0; block < blocks; ++block) scan_block(store, images[block], block);
}

void kz_store_plan_next(const kz_store* store, kz_store_plan* plan) {
  const u8 room = (u8)(KZ_STORE_LINES - store->used[store->block]);
  plan->sequence = (u16)(store->last + 1);
  if (plan->sequence == 0) plan->sequence = 1;
  plan->block = store->block;
  plan->line = store->used[store->block];
  plan->erase = 0;
  if (room >= store->parts) return;
  if (store->blocks == 2) plan->block = (u8)(1 - store->block);
  plan->line = 0;
  plan->erase = 1;
}

void kz_store_encode(u8* line, const kz_store* store, const kz_store_plan* plan, u8 part,
                     const u8* data) {
  u8 erases = store->erases[plan->block];
  u8 i;
  if (plan->erase && erases < 0xFF) ++erases;
  write16(line + SEQUENCE, plan->sequence);
  line[PART] = part;
  line[ERASES] = erases;
  for (i = 0; i < KZ_STORE_DATA; ++i) line[DATA + i] = data[i];
  line[OTHER_ERASES] = store->erases[1 - plan->block];
  line[SPARE] = BLANK;
  write16(line + CHECK, check_of(line));
}

const u8* kz_store_data(const kz_store* store, const u8* const* images, u8 part) {
  return images[store->block] + (u16)((u16)(store->line + part) * KZ_STORE_LINE) + DATA;
}

void kz_store_pack_calibration(u8* data, u8 part, const s16* centre, const s16* scale) {
  u8 joint = (u8)(part * JOINTS_PER_LINE);
  u8 i;
  for (i = 0; i < JOINTS_PER_LINE; ++i) {
    write16(data, (u16)centre[joint]);
    write16(data + 2, (u16)scale[joint]);
    data += 4;
    ++joint;
  }
}

void kz_store_load_calibration(const kz_store* store, const u8* const* images,
                               kz_startup* startup) {
  const u8* data = 0;
  u8 joint;
  if (store->sequence == 0) return;
  for (joint = 0; joint < KZ_JOINTS; ++joint) {
    if (joint % JOINTS_PER_LINE == 0) data = kz_store_data(store, images, joint / JOINTS_PER_LINE);
    startup->pot_centre[joint] = (s16)read16(data);
    startup->pot_scale[joint] = (s16)read16(data + 2);
    data += 4;
  }
  startup->calibration = store->block == 0 ? KZ_CALIBRATION_A : KZ_CALIBRATION_B;
}

void kz_store_pack_address(u8* data, u8 address, u8 shared_line) {
  u8 i;
  data[0] = address;
  data[1] = shared_line;
  for (i = 2; i < KZ_STORE_DATA; ++i) data[i] = BLANK;
}

void kz_store_load_address(const kz_store* store, const u8* const* images, kz_startup* startup) {
  const u8* data;
  if (store->sequence == 0) return;
  data = kz_store_data(store, images, 0);
  if (data[0] == 0 || data[0] > KZ_ADDRESS_LAST || data[1] > 1) return;
  startup->address = data[0];
  startup->shared_line = data[1];
}
