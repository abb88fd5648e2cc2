// Copies memory with the CPU's block transfer, two states per byte.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_COPY_H
#define KAZ_FIRMWARE_COPY_H

#include "shared/base/types.h"

// Copies `count` bytes, 1 to 255, with interrupts blocked. The assembler code saves ER6 itself, and changes
// ER6 only after it has read all operands. The compiler uses ER6 as frame pointer, ignores ER6 in the clobber
// list, and may pass an operand in ER6.
static inline void kz_copy(void* to, const void* from, u8 count) {
  __asm__ volatile(
      "mov.l er6,@-er7\n\tmov.b %X2,r4l\n\tmov.l %1,er5\n\tmov.l %0,er6\n\t"
      "eepmov.b\n\tmov.l @er7+,er6"
      :
      : "r"(to), "r"(from), "r"(count)
      : "r4", "r5", "memory");
}

#endif
