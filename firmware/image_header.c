// The application's header, and the mark of vectors and loader.
// SPDX-License-Identifier: Apache-2.0
#include "kz_build_id.h"
#include "shared/flash/image.h"
#include "shared/servo/servo.h"

typedef char header_has_32_bytes[sizeof(kz_image_header) == 32 ? 1 : -1];
typedef char mark_has_32_bytes[sizeof(kz_loader_mark) == 32 ? 1 : -1];

const kz_image_header kz_image_header_in_flash __attribute__((section(".header"))) = {
    KZ_IMAGE_ID,
    KZ_BOARD_ID,
    KZ_FIRMWARE_VERSION,
    KZ_BUILD_ID,
    0xFFFFFFFFUL,
    {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF},
    0xFFFF,
};

const kz_loader_mark kz_loader_mark_in_flash __attribute__((section(".lmark"))) = {
    KZ_LOADER_ID,
    {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,
     0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF},
    0xFFFF,
};
