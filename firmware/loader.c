// The loader's one decision: is there a whole application?
// SPDX-License-Identifier: Apache-2.0
#include "firmware/image.h"

u16 kz_loader_crc16(u16 crc, u8 byte);

static u16 crc_of(u16 crc, u32 from, u32 to) {
  const u8* byte = (const u8*)from;
  const u8* end = (const u8*)to;
  while (byte < end) crc = kz_loader_crc16(crc, *byte++);
  return crc;
}

// The application's CRC if header and CRC are right, else 0xFFFFFFFF.
u32 kz_loader_check(void) {
  const kz_image_header* header = (const kz_image_header*)KZ_APPLICATION_HEADER;
  u16 crc;
  if (header->image_id != KZ_IMAGE_ID || header->board_id != KZ_BOARD_ID) return 0xFFFFFFFFUL;
  if (header->length > KZ_APPLICATION_MAX ||
      header->length < KZ_APPLICATION_CODE - KZ_APPLICATION) {
    return 0xFFFFFFFFUL;
  }
  crc = crc_of(0xFFFF, KZ_APPLICATION, KZ_APPLICATION_CODE - sizeof header->crc);
  crc = crc_of(crc, KZ_APPLICATION_CODE, KZ_APPLICATION + header->length);
  return crc == header->crc ? crc : 0xFFFFFFFFUL;
}
