// What the board remembers in flash: the logs of shared/servo/store.h in blocks EB1 to EB3.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/memory.h"

#include "firmware/flash.h"
#include "shared/servo/store.h"

#define CALIBRATION_BLOCK 1  // EB1, and EB2 behind it
#define ADDRESS_BLOCK 3      // EB3
#define IMAGE_OF(block) ((const u8*)((u32)(block)*KZ_FLASH_BLOCK))

static const u8* const calibration_images[KZ_CALIBRATION_BLOCKS] = {
    IMAGE_OF(CALIBRATION_BLOCK), IMAGE_OF(CALIBRATION_BLOCK + 1)};
static const u8* const address_image[KZ_ADDRESS_BLOCKS] = {IMAGE_OF(ADDRESS_BLOCK)};

static kz_store calibration;
static kz_store address;

static void scan_calibration(void) {
  kz_store_scan(&calibration, calibration_images, KZ_CALIBRATION_BLOCKS, KZ_CALIBRATION_PARTS);
}

static void scan_address(void) {
  kz_store_scan(&address, address_image, KZ_ADDRESS_BLOCKS, KZ_ADDRESS_PARTS);
}

void kz_memory_load(kz_startup* startup) {
  scan_calibration();
  kz_store_load_calibration(&calibration, calibration_images, startup);
  scan_address();
  kz_store_load_address(&address, address_image, startup);
}

void kz_memory_report(kz_tick_input* input) {
  input->calibration_sequence = calibration.sequence;
  input->erases_a = calibration.erases[0];
  input->erases_b = calibration.erases[1];
}

// Is what the line says what stands in flash? `data` of the newest copy, which is the one just written.
static u8 reads_back(const u8* data, const u8* stored) {
  u8 i;
  for (i = 0; i < KZ_STORE_DATA; ++i) {
    if (data[i] != stored[i]) return 0;
  }
  return 1;
}

// The data that belong to a part of a copy.
typedef struct source {
  const s16* centre;  // calibration; 0: it is an address
  const s16* scale;
  u8 address;
  u8 shared_line;
} source;

static void pack(u8* data, const source* from, u8 part) {
  if (from->centre != 0) {
    kz_store_pack_calibration(data, part, from->centre, from->scale);
  } else {
    kz_store_pack_address(data, from->address, from->shared_line);
  }
}

static u8 write(const kz_store* store, const kz_store_plan* plan, u8 first_block,
                const source* from, u16* ticks) {
  const u8 block = (u8)(first_block + plan->block);
  u32 at = (u32)block * KZ_FLASH_BLOCK + (u16)(plan->line * KZ_STORE_LINE);
  u16 line[KZ_STORE_LINE / 2];  // words, for the flash
  u8 data[KZ_STORE_DATA];
  u8 done = 1;
  u8 part;
  kz_flash_open();
  if (plan->erase) done = kz_flash_erase(block);
  for (part = 0; part < store->parts && done; ++part) {
    pack(data, from, part);
    kz_store_encode((u8*)line, store, plan, part, data);
    done = kz_flash_program(at, (const u8*)line);
    at += KZ_STORE_LINE;
  }
  *ticks = (u16)(*ticks + kz_flash_close());
  return done;
}

// `store` has been scanned again since.
static u8 is_there(const kz_store* store, const kz_store_plan* plan, const u8* const* images,
                   const source* from) {
  u8 data[KZ_STORE_DATA];
  u8 part;
  if (store->sequence != plan->sequence || store->block != plan->block ||
      store->line != plan->line) {
    return 0;
  }
  for (part = 0; part < store->parts; ++part) {
    pack(data, from, part);
    if (!reads_back(data, kz_store_data(store, images, part))) return 0;
  }
  return 1;
}

u8 kz_memory_store_calibration(const kz_servo* servo, u16* ticks) {
  s16 centre[KZ_JOINTS];
  s16 scale[KZ_JOINTS];
  kz_store_plan plan;
  source from;
  u8 done;
  u8 i;
  for (i = 0; i < KZ_JOINTS; ++i) {
    centre[i] = servo->joint[i].pot_centre;
    scale[i] = servo->joint[i].pot_scale;
  }
  from.centre = centre;
  from.scale = scale;
  kz_store_plan_next(&calibration, &plan);
  done = write(&calibration, &plan, CALIBRATION_BLOCK, &from, ticks);
  scan_calibration();
  return (u8)(done && is_there(&calibration, &plan, calibration_images, &from));
}

u8 kz_memory_store_address(const kz_servo* servo, u16* ticks) {
  kz_store_plan plan;
  source from;
  u8 done;
  from.centre = 0;
  from.address = servo->new_address;
  from.shared_line = servo->new_shared_line;
  kz_store_plan_next(&address, &plan);
  done = write(&address, &plan, ADDRESS_BLOCK, &from, ticks);
  scan_address();
  return (u8)(done && is_there(&address, &plan, address_image, &from));
}
