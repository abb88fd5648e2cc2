// Header of programs by csmith, for host and H8S: types, a checksum and one line of output. After it, run.py
// adds the safe arithmetic that a program calls, from csmith's own header.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_CSMITH_H
#define KAZ_CSMITH_H

// Both sides have 32-bit int, long and pointers (-mint32, -m32).
typedef signed char int8_t;
typedef unsigned char uint8_t;
typedef short int16_t;
typedef unsigned short uint16_t;
typedef int int32_t;
typedef unsigned int uint32_t;
typedef long long int64_t;
typedef unsigned long long uint64_t;
typedef unsigned int size_t;
typedef int intptr_t;
typedef unsigned int uintptr_t;

#define INT8_MIN (-128)
#define INT8_MAX 127
#define UINT8_MAX 255
#define INT16_MIN (-32768)
#define INT16_MAX 32767
#define UINT16_MAX 65535
#define INT32_MIN (-2147483647 - 1)
#define INT32_MAX 2147483647
#define UINT32_MAX 4294967295U
#define INT64_MIN (-9223372036854775807LL - 1)
#define INT64_MAX 9223372036854775807LL
#define UINT64_MAX 18446744073709551615ULL
#define INT_MIN INT32_MIN
#define INT_MAX INT32_MAX
#define UINT_MAX UINT32_MAX
#define CHAR_BIT 8
#define NULL ((void*)0)
#define assert(condition)
// Programs print only indices of hashed values, if an argument requests it.
#define printf(...) ((void)0)

// Writes to standard output. Defined in host.c and start.s.
void kaz_put(const char* text, unsigned length);

static uint32_t kaz_crc = 0xffffffffU;

// CRC-32 of csmith's own runtime, without its table.
static void kaz_crc_byte(uint8_t byte) {
  int bit;
  kaz_crc ^= byte;
  for (bit = 0; bit < 8; ++bit) kaz_crc = kaz_crc & 1 ? kaz_crc >> 1 ^ 0xedb88320U : kaz_crc >> 1;
}

static void crc32_gentab(void) {}

static void transparent_crc(uint64_t value, const char* name, int flag) {
  int shift;
  (void)name;
  (void)flag;
  for (shift = 0; shift < 64; shift += 8) kaz_crc_byte((uint8_t)(value >> shift));
}

static void platform_main_begin(void) {}

#define crc32_context kaz_crc

static void platform_main_end(uint32_t crc, int flag) {
  char line[9];
  int digit;
  (void)flag;
  for (digit = 0; digit < 8; ++digit)
    line[digit] = "0123456789abcdef"[crc >> (28 - 4 * digit) & 15];
  line[8] = '\n';
  kaz_put(line, 9);
}

#endif
