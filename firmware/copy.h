// Copies memory with the CPU's block transfer: two states a byte.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_COPY_H
#define KAZ_FIRMWARE_COPY_H

#include "shared/base/types.h"

// 1 to 255 bytes; no interrupt is taken meanwhile.
static inline void kz_copy(void* to, const void* from, u8 count) {
  register const void* source __asm__("er5") = from;
  register void* target __asm__("er6") = to;
  register u8 left __asm__("r4") = count;
  __asm__ volatile("eepmov.b" : "+r"(source), "+r"(target), "+r"(left) : : "memory");
}

#endif
