// Integrity marks in flash. The loader checks the application's header before starting the application.
// Before a host erases flash, the host checks the loader's mark, which contains a CRC of vectors and loader.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_FLASH_IMAGE_H
#define KAZ_SHARED_FLASH_IMAGE_H

#include "shared/base/types.h"

// The flash map is in firmware/kaz.ld. The application begins with a jump table. The first entry jumps to the
// start of the application.
#define KZ_APPLICATION 0x1000UL
#define KZ_APPLICATION_HEADER 0x11E0UL
#define KZ_APPLICATION_CODE 0x1200UL
// Maximum size of the application, which ends before the loader's block.
#define KZ_APPLICATION_MAX 0xB000UL

#define KZ_IMAGE_ID 0x4B415A41UL  // "KAZA"
#define KZ_BOARD_ID 0x2128

// Header of the application, 32 bytes. tools/repo/gen/stamp_image.py sets `length` and `crc` after linking.
typedef struct kz_image_header {
  u32 image_id;
  u16 board_id;
  u16 version;
  u32 build_id;
  u32 length;  // number of bytes from KZ_APPLICATION to the application's end; includes this header
  u8 unused[14];
  u16 crc;  // kz_crc16, start 0xFFFF, over all `length` bytes except this field
} kz_image_header;

#define KZ_VECTORS_SIZE 0x400UL
#define KZ_LOADER 0xC000UL
#define KZ_LOADER_MARK 0xDFE0UL    // last line of the loader's block
#define KZ_LOADER_ID 0x4B415A4CUL  // "KAZL"

// Mark of the loader, 32 bytes. tools/repo/gen/stamp_image.py sets `crc` after linking.
typedef struct kz_loader_mark {
  u32 loader_id;
  u8 unused[26];
  // CRC of two areas: first the vectors, then the loader without this mark (kz_crc16, start 0xFFFF). The
  // vectors are the first KZ_VECTORS_SIZE bytes of flash. The loader begins at KZ_LOADER.
  u16 crc;
} kz_loader_mark;

#endif
