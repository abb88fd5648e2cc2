// The loader's decisions: is a host to be waited for, and is there a whole application?
// SPDX-License-Identifier: Apache-2.0
#include "firmware/restart.h"
#include "shared/board/board.h"
#include "shared/flash/image.h"
#include "shared/servo/snapshot.h"

// The loader's own copy of the CRC's table (loader_crc16.c).
#define kz_crc16_table kz_loader_crc16_table
#include "shared/protocol/crc16.h"

// To the flash writer, which waits so many seconds; 0: without end.
#define WAIT(seconds) (0xFFFF0000UL | (seconds))

// loader_start.S takes it from here.
__asm__("\t.global _kz_loader_board_id\n_kz_loader_board_id = 0x2128");
typedef char board_id_is_that_above[KZ_BOARD_ID == 0x2128 ? 1 : -1];

static u8 is_requested(void) {
  if (!kz_reset_by_watchdog() || KZ_RESTART_MARK != KZ_RESTART_LOADER) return 0;
  KZ_RESTART_MARK = KZ_RESTART_COMMAND;
  return 1;
}

static u16 crc_of(u16 crc, u32 from, u32 to) {
  const u8* byte = (const u8*)from;
  const u8* end = (const u8*)to;
  while (byte < end) crc = kz_crc16_step(crc, *byte++);
  return crc;
}

// The application's CRC if it is to be started, else WAIT.
u32 kz_loader_check(void) {
  const kz_image_header* header = (const kz_image_header*)KZ_APPLICATION_HEADER;
  u16 crc;
  if (is_requested()) return WAIT(KZ_LOADER_S);
  if (header->image_id != KZ_IMAGE_ID || header->board_id != KZ_BOARD_ID) return WAIT(0);
  if (header->length > KZ_APPLICATION_MAX ||
      header->length < KZ_APPLICATION_CODE - KZ_APPLICATION) {
    return WAIT(0);
  }
  crc = crc_of(0xFFFF, KZ_APPLICATION, KZ_APPLICATION_CODE - sizeof header->crc);
  crc = crc_of(crc, KZ_APPLICATION_CODE, KZ_APPLICATION + header->length);
  return crc == header->crc ? crc : WAIT(0);
}
