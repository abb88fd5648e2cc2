// The helpers that gcc calls for what the H8S has no instruction for: its own libgcc is for another
// core. Plain C; -mint32.
// SPDX-License-Identifier: Apache-2.0

typedef unsigned int u32;
typedef long long s64;
typedef unsigned long long u64;

// Big-endian halves.
typedef union {
  s64 whole;
  u64 plain;
  struct {
    u32 high, low;
  } half;
} Pair;

void* memcpy(void* to, const void* from, u32 count) {
  char* t = to;
  const char* f = from;
  while (count-- != 0) *t++ = *f++;
  return to;
}

void* memmove(void* to, const void* from, u32 count) {
  char* t = to;
  const char* f = from;
  if (t < f) return memcpy(to, from, count);
  while (count-- != 0) t[count] = f[count];
  return to;
}

void* memset(void* to, int value, u32 count) {
  char* t = to;
  while (count-- != 0) *t++ = (char)value;
  return to;
}

// Long division, bit by bit.
static u32 divide32(u32 a, u32 b, u32* remainder) {
  u32 quotient = 0, rest = 0;
  int bit;
  for (bit = 31; bit >= 0; --bit) {
    const u32 carry = rest >> 31;
    rest = rest << 1 | (a >> bit & 1);
    if (carry || rest >= b) {
      rest -= b;
      quotient |= 1U << bit;
    }
  }
  *remainder = rest;
  return quotient;
}

u32 __udivsi3(u32 a, u32 b) {
  u32 rest;
  return divide32(a, b, &rest);
}

u32 __umodsi3(u32 a, u32 b) {
  u32 rest;
  divide32(a, b, &rest);
  return rest;
}

int __divsi3(int a, int b) {
  u32 rest;
  const u32 q = divide32(a < 0 ? 0U - (u32)a : (u32)a, b < 0 ? 0U - (u32)b : (u32)b, &rest);
  return (int)((a < 0) != (b < 0) ? 0U - q : q);
}

int __modsi3(int a, int b) {
  u32 rest;
  divide32(a < 0 ? 0U - (u32)a : (u32)a, b < 0 ? 0U - (u32)b : (u32)b, &rest);
  return (int)(a < 0 ? 0U - rest : rest);
}

s64 __ashldi3(s64 a, int count) {
  Pair x;
  x.whole = a;
  if (count >= 32) {
    x.half.high = x.half.low << (count - 32);
    x.half.low = 0;
  } else if (count > 0) {
    x.half.high = x.half.high << count | x.half.low >> (32 - count);
    x.half.low <<= count;
  }
  return x.whole;
}

u64 __lshrdi3(u64 a, int count) {
  Pair x;
  x.plain = a;
  if (count >= 32) {
    x.half.low = x.half.high >> (count - 32);
    x.half.high = 0;
  } else if (count > 0) {
    x.half.low = x.half.low >> count | x.half.high << (32 - count);
    x.half.high >>= count;
  }
  return x.plain;
}

s64 __ashrdi3(s64 a, int count) {
  Pair x;
  x.whole = a;
  if (count >= 32) {
    x.half.low = (u32)((int)x.half.high >> (count - 32));
    x.half.high = (u32)((int)x.half.high >> 31);
  } else if (count > 0) {
    x.half.low = x.half.low >> count | x.half.high << (32 - count);
    x.half.high = (u32)((int)x.half.high >> count);
  }
  return x.whole;
}

s64 __negdi2(s64 a) {
  Pair x;
  x.whole = a;
  x.half.low = 0U - x.half.low;
  x.half.high = 0U - x.half.high - (x.half.low != 0);
  return x.whole;
}

// 0, 1, 2 for less, equal, greater.
int __ucmpdi2(u64 a, u64 b) {
  Pair x, y;
  x.plain = a;
  y.plain = b;
  if (x.half.high != y.half.high) return x.half.high < y.half.high ? 0 : 2;
  if (x.half.low != y.half.low) return x.half.low < y.half.low ? 0 : 2;
  return 1;
}

int __cmpdi2(s64 a, s64 b) {
  Pair x, y;
  x.whole = a;
  y.whole = b;
  if (x.half.high != y.half.high) return (int)x.half.high < (int)y.half.high ? 0 : 2;
  if (x.half.low != y.half.low) return x.half.low < y.half.low ? 0 : 2;
  return 1;
}

static u64 multiply32(u32 a, u32 b) {
  const u32 al = a & 0xffff, ah = a >> 16, bl = b & 0xffff, bh = b >> 16;
  const u32 low = al * bl, first = al * bh + (low >> 16), second = ah * bl + (first & 0xffff);
  Pair x;
  x.half.low = second << 16 | (low & 0xffff);
  x.half.high = ah * bh + (first >> 16) + (second >> 16);
  return x.plain;
}

s64 __muldi3(s64 a, s64 b) {
  Pair x, y, product;
  x.whole = a;
  y.whole = b;
  product.plain = multiply32(x.half.low, y.half.low);
  product.half.high += x.half.high * y.half.low + x.half.low * y.half.high;
  return product.whole;
}

static u64 divide64(u64 a, u64 b, u64* remainder) {
  Pair x, y, rest, quotient;
  int bit;
  x.plain = a;
  y.plain = b;
  rest.plain = quotient.plain = 0;
  for (bit = 63; bit >= 0; --bit) {
    const u32 carry = rest.half.high >> 31;
    const u32 next = bit >= 32 ? x.half.high >> (bit - 32) & 1 : x.half.low >> bit & 1;
    rest.half.high = rest.half.high << 1 | rest.half.low >> 31;
    rest.half.low = rest.half.low << 1 | next;
    if (carry || rest.half.high > y.half.high ||
        (rest.half.high == y.half.high && rest.half.low >= y.half.low)) {
      rest.half.high -= y.half.high + (rest.half.low < y.half.low);
      rest.half.low -= y.half.low;
      if (bit >= 32)
        quotient.half.high |= 1U << (bit - 32);
      else
        quotient.half.low |= 1U << bit;
    }
  }
  *remainder = rest.plain;
  return quotient.plain;
}

u64 __udivdi3(u64 a, u64 b) {
  u64 rest;
  return divide64(a, b, &rest);
}

u64 __umoddi3(u64 a, u64 b) {
  u64 rest;
  divide64(a, b, &rest);
  return rest;
}

static u64 magnitude(s64 a) {
  return a < 0 ? (u64)__negdi2(a) : (u64)a;
}

s64 __divdi3(s64 a, s64 b) {
  u64 rest;
  const s64 q = (s64)divide64(magnitude(a), magnitude(b), &rest);
  return (a < 0) != (b < 0) ? __negdi2(q) : q;
}

s64 __moddi3(s64 a, s64 b) {
  u64 rest;
  divide64(magnitude(a), magnitude(b), &rest);
  return a < 0 ? __negdi2((s64)rest) : (s64)rest;
}
