// Fixed-width integers for code that is compiled for the H8S/2128 and for the PC.
// SPDX-License-Identifier: Apache-2.0
//
// The H8 compiler has a 16-bit int, and the header stdint.h is missing. An expression in shared/ that could
// overflow 16 bits must cast its operands first: `(s32)a * b`, never `(s32)(a * b)`.
#ifndef KAZ_SHARED_BASE_TYPES_H
#define KAZ_SHARED_BASE_TYPES_H

typedef unsigned char u8;
typedef signed char s8;
typedef unsigned short u16;
typedef signed short s16;
#if defined(__H8300S__) || defined(__H8300H__)
typedef unsigned long u32;
typedef signed long s32;
#else
typedef unsigned int u32;
typedef signed int s32;
#endif

// Compile-time check of the widths.
typedef char kz_check_u8[(sizeof(u8) == 1) ? 1 : -1];
typedef char kz_check_u16[(sizeof(u16) == 2) ? 1 : -1];
typedef char kz_check_u32[(sizeof(u32) == 4) ? 1 : -1];

#endif
