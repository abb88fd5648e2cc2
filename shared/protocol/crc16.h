// Inline version of kz_crc16 (frame.h), for code that processes every byte.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_PROTOCOL_CRC16_H
#define KAZ_SHARED_PROTOCOL_CRC16_H

#include "shared/base/types.h"

#ifdef __cplusplus
extern "C" {
#endif

// Entry n is the remainder of n * x^16 modulo the CRC polynomial.
extern const u16 kz_crc16_table[256];

// Returns the CRC after one more byte; `crc` is the CRC before this byte.
static inline u16 kz_crc16_step(u16 crc, u8 byte) {
  return (u16)((u16)(crc << 8) ^ kz_crc16_table[(u16)(crc >> 8) ^ byte]);
}

#ifdef __cplusplus
}
#endif

#endif
