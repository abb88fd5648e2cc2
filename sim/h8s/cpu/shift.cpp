// Shifts and rotations by one and two bits.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/flags.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {
namespace {

template <Shift kind, class T, int times>
const Insn* shift(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_shift<kind, T>(c, reg<T>(c, i->rd), times));
  return i + 1;
}

// Six rows of one kind: the high nibble of the second byte selects size and distance.
#define KAZ_SHIFT(kind, name, first, b1, w1, l1, b2, w2, l2)                 \
  {first b1 "s", name ".b", "%s", shift<Shift::kind, u8, 1>, {1}},           \
      {first w1 "w", name ".w", "%w", shift<Shift::kind, u16, 1>, {1}},      \
      {first l1 "n", name ".l", "%n", shift<Shift::kind, u32, 1>, {1}},      \
      {first b2 "s", name ".b", "#2,%s", shift<Shift::kind, u8, 2>, {1}},    \
      {first w2 "w", name ".w", "#2,%w", shift<Shift::kind, u16, 2>, {1}}, { \
    first l2 "n", name ".l", "#2,%n", shift<Shift::kind, u32, 2>, {          \
      1                                                                      \
    }                                                                        \
  }
#define KAZ_LOW(kind, name, first) KAZ_SHIFT(kind, name, first, "0", "1", "3", "4", "5", "7")
#define KAZ_HIGH(kind, name, first) KAZ_SHIFT(kind, name, first, "8", "9", "B", "C", "D", "F")

const Opcode kShift[] = {
    KAZ_LOW(shll, "shll", "10"),   KAZ_HIGH(shal, "shal", "10"),  KAZ_LOW(shlr, "shlr", "11"),
    KAZ_HIGH(shar, "shar", "11"),  KAZ_LOW(rotxl, "rotxl", "12"), KAZ_HIGH(rotl, "rotl", "12"),
    KAZ_LOW(rotxr, "rotxr", "13"), KAZ_HIGH(rotr, "rotr", "13"),
};

#undef KAZ_SHIFT
#undef KAZ_LOW
#undef KAZ_HIGH

}  // namespace

std::span<const Opcode> shift_opcodes() {
  return kShift;
}

}  // namespace kaz::h8s
