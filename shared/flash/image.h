// The application's header in flash: by it the loader knows whether what lies there is whole. And the
// loader's mark: by it a host knows the same of vectors and loader, before it erases anything.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_FLASH_IMAGE_H
#define KAZ_SHARED_FLASH_IMAGE_H

#include "shared/base/types.h"

// Flash map: firmware/kaz.ld. The application starts with the jump table, whose first entry is its start.
#define KZ_APPLICATION 0x1000UL
#define KZ_APPLICATION_HEADER 0x11E0UL
#define KZ_APPLICATION_CODE 0x1200UL
#define KZ_APPLICATION_MAX 0xB000UL  // up to the loader's block

#define KZ_IMAGE_ID 0x4B415A41UL  // "KAZA"
#define KZ_BOARD_ID 0x2128

// 32 bytes. tools/gen/stamp_image.py fills in `length` and `crc` after linking.
typedef struct kz_image_header {
  u32 image_id;
  u16 board_id;
  u16 version;
  u32 build_id;
  u32 length;  // bytes from KZ_APPLICATION on
  u8 unused[14];
  u16 crc;  // kz_crc16, start 0xFFFF, over all `length` bytes but these two
} kz_image_header;

#define KZ_VECTORS_SIZE 0x400UL
#define KZ_LOADER 0xC000UL
#define KZ_LOADER_MARK 0xDFE0UL    // the last line of the loader's block
#define KZ_LOADER_ID 0x4B415A4CUL  // "KAZL"

// 32 bytes. tools/gen/stamp_image.py fills in `crc` after linking.
typedef struct kz_loader_mark {
  u32 loader_id;
  u8 unused[26];
  u16 crc;  // kz_crc16, start 0xFFFF, over KZ_VECTORS_SIZE bytes at 0, then from KZ_LOADER to the mark
} kz_loader_mark;

#endif
