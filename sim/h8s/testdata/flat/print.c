// print: as much of printf as test programs need.
// SPDX-License-Identifier: Apache-2.0
#include <stdarg.h>

#include "host.h"

struct out {
  char bytes[64];
  unsigned used;
};

static void flush(struct out* out) {
  write(1, out->bytes, out->used);
  out->used = 0;
}

static void put(struct out* out, char ch) {
  out->bytes[out->used++] = ch;
  if (out->used == sizeof out->bytes) flush(out);
}

/* 16 bits at a time: the compiler needs no library for divisions of 32 bits by 16 this way. */
static unsigned divide(unsigned long* value, unsigned by) {
  unsigned long high = *value >> 16, low;
  unsigned rest = (unsigned)high % by;
  high = (unsigned)high / by;
  low = 0;
  {
    unsigned long part = *value & 0xffff;
    int bit;
    for (bit = 15; bit >= 0; --bit) {
      rest = rest << 1 | (unsigned)(part >> bit & 1);
      low <<= 1;
      if (rest >= by) {
        rest -= by;
        low |= 1;
      }
    }
  }
  *value = high << 16 | low;
  return rest;
}

static void number(struct out* out, unsigned long value, unsigned base, int negative, int width,
                   char fill) {
  char digits[12];
  int count = 0;
  do {
    digits[count++] = "0123456789abcdef"[divide(&value, base)];
  } while (value != 0);
  if (negative && fill == '0') put(out, '-');
  width -= count + (negative != 0);
  while (width-- > 0) put(out, fill);
  if (negative && fill != '0') put(out, '-');
  while (count > 0) put(out, digits[--count]);
}

void print(const char* format, ...) {
  struct out out;
  va_list args;
  out.used = 0;
  va_start(args, format);
  for (; *format; ++format) {
    int is_long = 0, width = 0;
    char fill = ' ';
    if (*format != '%') {
      put(&out, *format);
      continue;
    }
    ++format;
    if (*format == '0') fill = *format++;
    while (*format >= '0' && *format <= '9') width = width * 10 + (*format++ - '0');
    if (*format == 'l') {
      is_long = 1;
      ++format;
    }
    if (*format == 's') {
      const char* text = va_arg(args, const char*);
      while (*text) put(&out, *text++);
    } else if (*format == 'c') {
      put(&out, (char)va_arg(args, int));
    } else if (*format == 'd') {
      const long value = is_long ? va_arg(args, long) : va_arg(args, int);
      number(&out, value < 0 ? -(unsigned long)value : (unsigned long)value, 10, value < 0, width,
             fill);
    } else if (*format == 'u' || *format == 'x') {
      const unsigned long value = is_long ? va_arg(args, unsigned long) : va_arg(args, unsigned);
      number(&out, value, *format == 'u' ? 10 : 16, 0, width, fill);
    } else {
      put(&out, *format);
      if (*format == 0) break;
    }
  }
  va_end(args);
  flush(&out);
}
