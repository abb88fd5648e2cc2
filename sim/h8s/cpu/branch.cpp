// Branches, jumps, calls and returns.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/flags.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {
namespace {

template <int condition>
bool holds(const Flags& f) {
  const bool less = ((f.n ^ f.v) >> 31) != 0;
  if constexpr (condition == 0x0) return true;
  if constexpr (condition == 0x1) return false;
  if constexpr (condition == 0x2) return f.c == 0 && f.z != 0;
  if constexpr (condition == 0x3) return f.c != 0 || f.z == 0;
  if constexpr (condition == 0x4) return f.c == 0;
  if constexpr (condition == 0x5) return f.c != 0;
  if constexpr (condition == 0x6) return f.z != 0;
  if constexpr (condition == 0x7) return f.z == 0;
  if constexpr (condition == 0x8) return f.v >> 31 == 0;
  if constexpr (condition == 0x9) return f.v >> 31 != 0;
  if constexpr (condition == 0xa) return f.n >> 31 == 0;
  if constexpr (condition == 0xb) return f.n >> 31 != 0;
  if constexpr (condition == 0xc) return !less;
  if constexpr (condition == 0xd) return less;
  if constexpr (condition == 0xe) return f.z != 0 && !less;
  return f.z == 0 || less;
}

// imm is the displacement in bytes. Decoding replaces this by the near form if the target is in the same
// memory region; see near_branch.
u32 target(const Cpu& c, const Insn* i) {
  return pc_of(c, i) + 2u * i->units + i->imm;
}

template <int condition>
const Insn* branch_far(Cpu& c, const Insn* i) {
  if (!holds<condition>(c.flags)) return i + i->units;
  return jump_to(c, i, target(c, i));
}

// imm is the distance to the target in units.
template <int condition>
const Insn* branch_near(Cpu& c, const Insn* i) {
  if (!holds<condition>(c.flags)) return i + i->units;
  return record_jump(c, i, i + static_cast<std::int32_t>(i->imm));
}

void push_return(Cpu& c, u32 address) {
  if (c.normal)
    push<u16>(c, static_cast<u16>(address));
  else
    push<u32>(c, address & 0xffffff);
}

u32 vector(Cpu& c, u32 address) {
  return c.normal ? load16(c, address) : load32(c, address);
}

const Insn* bsr(Cpu& c, const Insn* i) {
  push_return(c, pc_of(c, i) + 2u * i->units);
  return jump_to(c, i, target(c, i));
}

const Insn* jmp_register(Cpu& c, const Insn* i) {
  return jump_to(c, i, ereg(c, i->rs));
}
const Insn* jmp_absolute(Cpu& c, const Insn* i) {
  return jump_to(c, i, i->imm);
}
const Insn* jmp_indirect(Cpu& c, const Insn* i) {
  return jump_to(c, i, vector(c, i->imm));
}

const Insn* jsr_register(Cpu& c, const Insn* i) {
  const u32 to = ereg(c, i->rs);
  push_return(c, pc_of(c, i) + 2);
  return jump_to(c, i, to);
}

const Insn* jsr_absolute(Cpu& c, const Insn* i) {
  push_return(c, pc_of(c, i) + 4);
  return jump_to(c, i, i->imm);
}

const Insn* jsr_indirect(Cpu& c, const Insn* i) {
  const u32 to = vector(c, i->imm);
  push_return(c, pc_of(c, i) + 2);
  return jump_to(c, i, to);
}

const Insn* rts(Cpu& c, const Insn* i) {
  const u32 to = c.normal ? pop<u16>(c) : pop<u32>(c);
  return c.fault == Fault::stack ? i + 1 : jump_to(c, i, to);
}

#define KAZ_BRANCH(digit, name)                                \
  {"4" #digit "jj", name, "%j", branch_far<0x##digit>, {2}}, { \
    "58" #digit "0 jjjj", name, "%j", branch_far<0x##digit>, { \
      2, 0, 0, 0, 0, 1                                         \
    }                                                          \
  }

const Opcode kBranch[] = {
    KAZ_BRANCH(0, "bra"),
    KAZ_BRANCH(1, "brn"),
    KAZ_BRANCH(2, "bhi"),
    KAZ_BRANCH(3, "bls"),
    KAZ_BRANCH(4, "bcc"),
    KAZ_BRANCH(5, "bcs"),
    KAZ_BRANCH(6, "bne"),
    KAZ_BRANCH(7, "beq"),
    KAZ_BRANCH(8, "bvc"),
    KAZ_BRANCH(9, "bvs"),
    KAZ_BRANCH(A, "bpl"),
    KAZ_BRANCH(B, "bmi"),
    KAZ_BRANCH(C, "bge"),
    KAZ_BRANCH(D, "blt"),
    KAZ_BRANCH(E, "bgt"),
    KAZ_BRANCH(F, "ble"),
    {"55jj", "bsr", "%j", bsr, {2, 0, 2}},
    {"5C00 jjjj", "bsr", "%j", bsr, {2, 0, 2, 0, 0, 1}},
    {"59m0", "jmp", "@%m", jmp_register, {2}},
    {"5Aaa aaaa", "jmp", "@%a", jmp_absolute, {2, 0, 0, 0, 0, 1}},
    {"5Bvv", "jmp", "@@%v", jmp_indirect, {2, 2, 0, 0, 0, 1}},
    {"5Dm0", "jsr", "@%m", jsr_register, {2, 0, 2}},
    {"5Eaa aaaa", "jsr", "@%a", jsr_absolute, {2, 0, 2, 0, 0, 1}},
    {"5Fvv", "jsr", "@@%v", jsr_indirect, {2, 2, 2}},
    {"5470", "rts", "", rts, {2, 0, 2, 0, 0, 1}},
};

#undef KAZ_BRANCH

template <int... conditions>
Handler near_of(Handler far, std::integer_sequence<int, conditions...>) {
  Handler near = nullptr;
  ((far == branch_far<conditions> ? void(near = branch_near<conditions>) : void()), ...);
  return near;
}

}  // namespace

Handler near_branch(Handler far) {
  return near_of(far, std::make_integer_sequence<int, 16>{});
}

std::span<const Opcode> branch_opcodes() {
  return kBranch;
}

}  // namespace kaz::h8s
