// Arithmetic operations on 8, 16 and 32 bits. Each operation sets the condition codes (programming manual).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

using u8 = std::uint8_t;
using u16 = std::uint16_t;
using u32 = std::uint32_t;

// Each function returns the result of one operation and sets the flags in Cpu::flags.

template <class T>
inline constexpr int kBits = 8 * static_cast<int>(sizeof(T));

// Shifts an operand to the top bits of a 32-bit word. The members of Flags have this format.
template <class T>
u32 up(u32 value) {
  return value << (32 - kBits<T>);
}

template <class T>
T flags_logic(Cpu& c, T result) {
  c.flags.n = c.flags.z = up<T>(result);
  c.flags.v = 0;
  return result;
}

template <class T>
T flags_add(Cpu& c, T a, T b) {
  const T r = static_cast<T>(a + b);
  c.flags.n = c.flags.z = up<T>(r);
  c.flags.v = up<T>(static_cast<u32>((a ^ r) & (b ^ r)));
  c.flags.h = up<T>(static_cast<u32>(a ^ b ^ r));
  c.flags.c = r < a;
  return r;
}

template <class T>
T flags_sub(Cpu& c, T a, T b) {
  const T r = static_cast<T>(a - b);
  c.flags.n = c.flags.z = up<T>(r);
  c.flags.v = up<T>(static_cast<u32>((a ^ b) & (a ^ r)));
  c.flags.h = up<T>(static_cast<u32>(a ^ b ^ r));
  c.flags.c = a < b;
  return r;
}

// H is the carry or borrow into the top four bits of the operand. If `a` and `b` are the operands and `r` is
// the result, one bit of `a ^ b ^ r` has the value of H. For a byte, H is in bit 4; for a word, in bit 12;
// for a long word, in bit 28. The function up() moves H to bit 28.

// Addition with carry. Clears Z but never sets Z. A program can add two long numbers byte by byte: the lowest
// bytes with ADD, and all other bytes with ADDX. After the last addition, Z shows whether the whole sum is 0.
inline u8 flags_addx(Cpu& c, u8 a, u8 b) {
  const u32 sum = static_cast<u32>(a) + b + c.flags.c;
  const u8 r = static_cast<u8>(sum);
  c.flags.n = up<u8>(r);
  c.flags.z |= r;
  c.flags.v = up<u8>(static_cast<u32>((a ^ r) & (b ^ r)));
  c.flags.h = up<u8>(static_cast<u32>(a ^ b ^ r));
  c.flags.c = sum >> 8;
  return r;
}

// Subtraction with borrow. Treats Z like flags_addx.
inline u8 flags_subx(Cpu& c, u8 a, u8 b) {
  const u32 difference = static_cast<u32>(a) - b - c.flags.c;
  const u8 r = static_cast<u8>(difference);
  c.flags.n = up<u8>(r);
  c.flags.z |= r;
  c.flags.v = up<u8>(static_cast<u32>((a ^ b) & (a ^ r)));
  c.flags.h = up<u8>(static_cast<u32>(a ^ b ^ r));
  c.flags.c = difference >> 8 & 1;
  return r;
}

// INC and DEC do not change H and C.
template <class T>
T flags_inc(Cpu& c, T a, T by) {
  const T r = static_cast<T>(a + by);
  c.flags.n = c.flags.z = up<T>(r);
  c.flags.v = up<T>(static_cast<u32>((a ^ r) & (by ^ r)));
  return r;
}

template <class T>
T flags_dec(Cpu& c, T a, T by) {
  const T r = static_cast<T>(a - by);
  c.flags.n = c.flags.z = up<T>(r);
  c.flags.v = up<T>(static_cast<u32>((a ^ by) & (a ^ r)));
  return r;
}

enum class Shift { shll, shal, shlr, shar, rotxl, rotl, rotxr, rotr };

template <Shift kind, class T>
T flags_shift(Cpu& c, T a, int times) {
  constexpr int top = kBits<T> - 1;
  u32 x = a, carry = c.flags.c, changed = 0;
  for (int i = 0; i < times; ++i) {
    const u32 high = x >> top & 1, low = x & 1;
    if constexpr (kind == Shift::shll || kind == Shift::shal) {
      x <<= 1;
      carry = high;
    } else if constexpr (kind == Shift::rotl) {
      x = x << 1 | high;
      carry = high;
    } else if constexpr (kind == Shift::rotxl) {
      x = x << 1 | carry;
      carry = high;
    } else if constexpr (kind == Shift::shlr) {
      x = x >> 1;
      carry = low;
    } else if constexpr (kind == Shift::shar) {
      x = x >> 1 | high << top;
      carry = low;
    } else if constexpr (kind == Shift::rotr) {
      x = x >> 1 | low << top;
      carry = low;
    } else {
      x = x >> 1 | carry << top;
      carry = low;
    }
    if constexpr (kind == Shift::shal) changed |= (x >> top & 1) ^ high;
    x = static_cast<T>(x);
  }
  c.flags.c = carry;
  c.flags.n = c.flags.z = up<T>(x);
  c.flags.v = changed << 31;
  return static_cast<T>(x);
}

}  // namespace kaz::h8s
