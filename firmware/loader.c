// The loader's decisions: is it to wait, and is there a whole application?
// SPDX-License-Identifier: Apache-2.0
#include "firmware/image.h"
#include "firmware/restart.h"
#include "shared/board/board.h"
#include "shared/servo/tick.h"

// The loader's own copy of the CRC's table (loader_crc16.c).
#define kz_crc16_table kz_loader_crc16_table
#include "shared/protocol/crc16.h"

#define STATES_PER_LOOP 3

// Everything is as the reset left it: every pin an input, the watchdog stopped.
static void wait_if_asked(void) {
  u32 left = KZ_LOADER_S * (KZ_CLOCK_HZ / STATES_PER_LOOP);
  if (!kz_reset_by_watchdog() || KZ_RESTART_MARK != KZ_RESTART_LOADER) return;
  KZ_RESTART_MARK = KZ_RESTART_COMMAND;
  __asm__ volatile("0:\tdec.l #1,%0\n\tbne 0b" : "+r"(left));
}

static u16 crc_of(u16 crc, u32 from, u32 to) {
  const u8* byte = (const u8*)from;
  const u8* end = (const u8*)to;
  while (byte < end) crc = kz_crc16_step(crc, *byte++);
  return crc;
}

// The application's CRC if header and CRC are right, else 0xFFFFFFFF.
u32 kz_loader_check(void) {
  const kz_image_header* header = (const kz_image_header*)KZ_APPLICATION_HEADER;
  u16 crc;
  wait_if_asked();
  if (header->image_id != KZ_IMAGE_ID || header->board_id != KZ_BOARD_ID) return 0xFFFFFFFFUL;
  if (header->length > KZ_APPLICATION_MAX ||
      header->length < KZ_APPLICATION_CODE - KZ_APPLICATION) {
    return 0xFFFFFFFFUL;
  }
  crc = crc_of(0xFFFF, KZ_APPLICATION, KZ_APPLICATION_CODE - sizeof header->crc);
  crc = crc_of(crc, KZ_APPLICATION_CODE, KZ_APPLICATION + header->length);
  return crc == header->crc ? crc : 0xFFFFFFFFUL;
}
