// MOV in all sizes and addressing modes, PUSH and POP among them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/flags.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {
namespace {

// rs: source register or address register of a load; rd: destination or address register of a
// store.

template <class T>
const Insn* mov_immediate(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_logic<T>(c, static_cast<T>(i->imm)));
  return i + i->units;
}

template <class T>
const Insn* mov_register(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_logic<T>(c, reg<T>(c, i->rs)));
  return i + 1;
}

// @ERs and @(d,ERs): the displacement is 0 for the former.
template <class T>
const Insn* mov_load(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_logic<T>(c, load<T>(c, ereg(c, i->rs) + i->imm)));
  return i + i->units;
}

template <class T>
const Insn* mov_store(Cpu& c, const Insn* i) {
  store<T>(c, ereg(c, i->rd) + i->imm, flags_logic<T>(c, reg<T>(c, i->rs)));
  return i + i->units;
}

template <class T>
const Insn* mov_load_absolute(Cpu& c, const Insn* i) {
  set_reg<T>(c, i->rd, flags_logic<T>(c, load<T>(c, i->imm)));
  return i + i->units;
}

template <class T>
const Insn* mov_store_absolute(Cpu& c, const Insn* i) {
  store<T>(c, i->imm, flags_logic<T>(c, reg<T>(c, i->rs)));
  return i + i->units;
}

// With ER7 as pointer the address must be in RAM; a byte access leaves SP odd. Rd may be part of ERs: the
// loaded value is written last.
template <class T>
const Insn* mov_load_increment(Cpu& c, const Insn* i) {
  const std::uint32_t address = ereg(c, i->rs);
  const bool stack = i->rs == 4 * 7;
  if (stack && !stack_ok(c, address)) return i + i->units;
  const T value = load<T>(c, address);
  set_reg<std::uint32_t>(c, i->rs, address + std::uint32_t{sizeof(T)});
  set_reg<T>(c, i->rd, flags_logic<T>(c, value));
  return i + i->units;
}

// Rs may be part of ERd: Options::predecrement_stores_decremented.
template <class T>
const Insn* mov_store_decrement(Cpu& c, const Insn* i) {
  const bool stack = i->rd == 4 * 7;
  const T before = reg<T>(c, i->rs);
  const std::uint32_t address = ereg(c, i->rd) - std::uint32_t{sizeof(T)};
  set_reg<std::uint32_t>(c, i->rd, address);
  if (stack && !stack_ok(c, address)) return i + i->units;
  const T value = c.predecrement_stores_decremented ? reg<T>(c, i->rs) : before;
  store<T>(c, address, flags_logic<T>(c, value));
  return i + i->units;
}

using B = std::uint8_t;
using W = std::uint16_t;
using L = std::uint32_t;

// Counts {I, J, K, L, M, N}.
const Opcode kMove[] = {
    {"Fsii", "mov.b", "#%i,%s", mov_immediate<B>, {1}},
    {"790w iiii", "mov.w", "#%i,%w", mov_immediate<W>, {2}},
    {"7A0n iiii iiii", "mov.l", "#%i,%n", mov_immediate<L>, {3}},
    {"0Crs", "mov.b", "%r,%s", mov_register<B>, {1}},
    {"0Duw", "mov.w", "%u,%w", mov_register<W>, {1}},
    {"0FMn", "mov.l", "%M,%n", mov_register<L>, {1}},

    {"68ms", "mov.b", "@%m,%s", mov_load<B>, {1, 0, 0, 1}},
    {"69mw", "mov.w", "@%m,%w", mov_load<W>, {1, 0, 0, 0, 1}},
    {"0100 69mn", "mov.l", "@%m,%n", mov_load<L>, {2, 0, 0, 0, 2}},
    {"68Nr", "mov.b", "%r,@%N", mov_store<B>, {1, 0, 0, 1}},
    {"69Nu", "mov.w", "%u,@%N", mov_store<W>, {1, 0, 0, 0, 1}},
    {"0100 69Nm", "mov.l", "%m,@%N", mov_store<L>, {2, 0, 0, 0, 2}},

    {"6Ems dddd", "mov.b", "@(%d,%m),%s", mov_load<B>, {2, 0, 0, 1}},
    {"6Fmw dddd", "mov.w", "@(%d,%m),%w", mov_load<W>, {2, 0, 0, 0, 1}},
    {"0100 6Fmn dddd", "mov.l", "@(%d,%m),%n", mov_load<L>, {3, 0, 0, 0, 2}},
    {"6ENr dddd", "mov.b", "%r,@(%d,%N)", mov_store<B>, {2, 0, 0, 1}},
    {"6FNu dddd", "mov.w", "%u,@(%d,%N)", mov_store<W>, {2, 0, 0, 0, 1}},
    {"0100 6FNm dddd", "mov.l", "%m,@(%d,%N)", mov_store<L>, {3, 0, 0, 0, 2}},

    {"78Y0 6A2s dddd dddd", "mov.b", "@(%d,%Y),%s", mov_load<B>, {4, 0, 0, 1}},
    {"78Y0 6B2w dddd dddd", "mov.w", "@(%d,%Y),%w", mov_load<W>, {4, 0, 0, 0, 1}},
    {"0100 78Y0 6B2n dddd dddd", "mov.l", "@(%d,%Y),%n", mov_load<L>, {5, 0, 0, 0, 2}},
    {"78X0 6AAr dddd dddd", "mov.b", "%r,@(%d,%X)", mov_store<B>, {4, 0, 0, 1}},
    {"78X0 6BAu dddd dddd", "mov.w", "%u,@(%d,%X)", mov_store<W>, {4, 0, 0, 0, 1}},
    {"0100 78X0 6BAm dddd dddd", "mov.l", "%m,@(%d,%X)", mov_store<L>, {5, 0, 0, 0, 2}},

    {"6Cms", "mov.b", "@%m+,%s", mov_load_increment<B>, {1, 0, 0, 1, 0, 1}},
    {"6Dmw", "mov.w", "@%m+,%w", mov_load_increment<W>, {1, 0, 0, 0, 1, 1}},
    {"0100 6Dmn", "mov.l", "@%m+,%n", mov_load_increment<L>, {2, 0, 0, 0, 2, 1}},
    {"6CNr", "mov.b", "%r,@-%N", mov_store_decrement<B>, {1, 0, 0, 1, 0, 1}},
    {"6DNu", "mov.w", "%u,@-%N", mov_store_decrement<W>, {1, 0, 0, 0, 1, 1}},
    {"0100 6DNm", "mov.l", "%m,@-%N", mov_store_decrement<L>, {2, 0, 0, 0, 2, 1}},

    {"2saa", "mov.b", "@%a,%s", mov_load_absolute<B>, {1, 0, 0, 1}},
    {"3raa", "mov.b", "%r,@%a", mov_store_absolute<B>, {1, 0, 0, 1}},
    {"6A0s aaaa", "mov.b", "@%a,%s", mov_load_absolute<B>, {2, 0, 0, 1}},
    {"6B0w aaaa", "mov.w", "@%a,%w", mov_load_absolute<W>, {2, 0, 0, 0, 1}},
    {"0100 6B0n aaaa", "mov.l", "@%a,%n", mov_load_absolute<L>, {3, 0, 0, 0, 2}},
    {"6A8r aaaa", "mov.b", "%r,@%a", mov_store_absolute<B>, {2, 0, 0, 1}},
    {"6B8u aaaa", "mov.w", "%u,@%a", mov_store_absolute<W>, {2, 0, 0, 0, 1}},
    {"0100 6B8m aaaa", "mov.l", "%m,@%a", mov_store_absolute<L>, {3, 0, 0, 0, 2}},
    {"6A2s aaaa aaaa", "mov.b", "@%a,%s", mov_load_absolute<B>, {3, 0, 0, 1}},
    {"6B2w aaaa aaaa", "mov.w", "@%a,%w", mov_load_absolute<W>, {3, 0, 0, 0, 1}},
    {"0100 6B2n aaaa aaaa", "mov.l", "@%a,%n", mov_load_absolute<L>, {4, 0, 0, 0, 2}},
    {"6AAr aaaa aaaa", "mov.b", "%r,@%a", mov_store_absolute<B>, {3, 0, 0, 1}},
    {"6BAu aaaa aaaa", "mov.w", "%u,@%a", mov_store_absolute<W>, {3, 0, 0, 0, 1}},
    {"0100 6BAm aaaa aaaa", "mov.l", "%m,@%a", mov_store_absolute<L>, {4, 0, 0, 0, 2}},
};

}  // namespace

std::span<const Opcode> move_opcodes() {
  return kMove;
}

}  // namespace kaz::h8s
