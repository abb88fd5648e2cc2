// The code that all blocks share: entry, exits, and the call of an instruction's handler.
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>

#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s::translate {
namespace {

host::Mem field(std::size_t offset) {
  return host::ptr(kCpu, static_cast<std::int32_t>(offset));
}

constexpr std::uint8_t kIds[] = {0, 3, 1, 2, 8, 9, 10, 11};

void emit_registers_in(host::Assembler& a) {
  for (unsigned n = 0; n < 8; ++n) a.mov(host::gpd(kIds[n]), field(offsetof(Cpu, er) + 4 * n));
}

void emit_registers_out(host::Assembler& a) {
  for (unsigned n = 0; n < 8; ++n) a.mov(field(offsetof(Cpu, er) + 4 * n), host::gpd(kIds[n]));
}

// Before a handler, as the interpreter has it: Cpu::now is the end of the instruction. Then its arguments.
void emit_state_out(host::Assembler& a) {
  emit_registers_out(a);
  a.mov(host::rax, field(offsetof(Cpu, stop)));
  a.sub(host::rax, kLeft);
  a.sub(host::rax, host::rsi);
  a.mov(field(offsetof(Cpu, now)), host::rax);
  a.mov(field(offsetof(Cpu, ip)), host::rdi);
  a.mov(host::rdx, host::rsi);
  a.mov(host::rsi, host::rdi);
  a.mov(host::rdi, kCpu);
}

void emit_interpret(host::Assembler& a) {
  emit_state_out(a);
  a.sub(host::rsp, 8);
  a.mov(host::rax, reinterpret_cast<std::uint64_t>(&run_handler));
  a.call(host::rax);
  a.add(host::rsp, 8);
  a.mov(kLeft, host::rax);
  emit_registers_in(a);
  a.test(kLeft, kLeft);
  a.ret();
}

// Time passes during an access: Cpu::stop becomes earlier.
void emit_access(host::Assembler& a, std::uint64_t access) {
  using host::r15;
  emit_registers_out(a);
  a.mov(host::edx, host::r15d);
  a.mov(r15, field(offsetof(Cpu, stop)));
  a.mov(host::rax, r15);
  a.sub(host::rax, kLeft);
  a.sub(host::rax, host::rsi);
  a.mov(field(offsetof(Cpu, now)), host::rax);
  a.mov(field(offsetof(Cpu, ip)), host::rdi);
  a.mov(host::rsi, kCpu);
  a.sub(host::rsp, 8);
  a.mov(host::rax, access);
  a.call(host::rax);
  a.add(host::rsp, 8);
  a.mov(host::edi, host::eax);
  emit_registers_in(a);
  a.sub(kLeft, r15);
  a.add(kLeft, field(offsetof(Cpu, stop)));
  a.ret();
}

// The block is left after the instruction. Not by forget_all() itself: that would interrupt an EEPMOV.W.
void leave_discarded(Cpu& c) {
  if (c.code_discarded) [[unlikely]]
    end_stretch(c);
}

std::uint32_t load_register8(const Insn* ip, Cpu& c) {
  const std::uint32_t address = ip->imm & c.mask;
  const std::uint32_t value = c.observed ? c.bus->load8(address) : c.bus->load_io8(address);
  leave_discarded(c);
  return value;
}

std::uint32_t load_register16(const Insn* ip, Cpu& c) {
  const std::uint32_t address = ip->imm & c.mask;
  const std::uint32_t value = c.observed ? c.bus->load16(address) : c.bus->load_io16(address);
  leave_discarded(c);
  return value;
}

void store_register8(const Insn* ip, Cpu& c, std::uint32_t value) {
  const std::uint32_t address = ip->imm & c.mask;
  const auto byte = static_cast<std::uint8_t>(value);
  c.observed ? c.bus->store8(address, byte) : c.bus->store_io8(address, byte);
  leave_discarded(c);
}

void store_register16(const Insn* ip, Cpu& c, std::uint32_t value) {
  const std::uint32_t address = ip->imm & c.mask;
  const auto word = static_cast<std::uint16_t>(value);
  c.observed ? c.bus->store16(address, word) : c.bus->store_io16(address, word);
  leave_discarded(c);
}

void emit_go_elsewhere(host::Assembler& a, const asmjit::Label& leave, const Entry* entries) {
  emit_state_out(a);
  a.mov(host::rdx, reinterpret_cast<std::uint64_t>(entries));
  a.mov(host::rax, reinterpret_cast<std::uint64_t>(&run_handler_elsewhere));
  a.call(host::rax);
  a.mov(host::rsi, host::rax);
  a.test(host::rsi, host::rsi);
  a.jz(leave);
  emit_registers_in(a);
  a.mov(kLeft, field(offsetof(Cpu, stop)));
  a.sub(kLeft, field(offsetof(Cpu, now)));
  a.jmp(host::rsi);
}

// A write to a unit behind the instruction makes it undecoded, but keeps its translation.
Handler handler_of(Cpu& c, const Insn* ip) {
  return ip->run ? ip->run : decode_in_place(c, ip);
}

}  // namespace

std::int64_t run_handler(Cpu& c, const Insn* ip, std::int64_t rest) {
  const Handler run = handler_of(c, ip);
  const Insn* const next = ip + ip->units;
  c.ip = run(c, ip);
  if (c.ip != next || c.now >= c.stop || c.code_discarded) return 0;
  return c.stop - c.now - rest;
}

const void* run_handler_elsewhere(Cpu& c, const Insn* ip, const Entry* entries) {
  c.ip = handler_of(c, ip)(c, ip);
  if (c.now >= c.stop || c.code_discarded || c.ip == &c.outside) return nullptr;
  return entries[c.ip - c.code].code;
}

void emit_gate(host::Assembler& a, const GateLabels& labels, const Entry* entries) {
  const host::Gp saved[] = {host::rbx, host::rbp, host::r12, host::r13, host::r14, host::r15};
  for (const host::Gp& r : saved) a.push(r);
  a.sub(host::rsp, 8);
  a.mov(kCpu, host::rdi);
  emit_registers_in(a);
  a.mov(kRamBase, field(offsetof(Cpu, ram)));
  a.xor_(kExecuted.r32(), kExecuted.r32());
  a.mov(kLeft, field(offsetof(Cpu, stop)));
  a.sub(kLeft, field(offsetof(Cpu, now)));
  a.jmp(host::rsi);

  const auto emit_end = [&] {
    a.add(field(offsetof(Cpu, executed)), kExecuted);
    a.mov(host::eax, host::esi);
    a.add(host::rsp, 8);
    for (int n = 5; n >= 0; --n) a.pop(saved[n]);
    a.ret();
  };
  a.bind(labels.leave);
  emit_registers_out(a);
  a.shl(host::rdi, 4);
  a.add(host::rdi, field(offsetof(Cpu, code)));
  a.mov(field(offsetof(Cpu, ip)), host::rdi);
  a.mov(host::rax, field(offsetof(Cpu, stop)));
  a.sub(host::rax, kLeft);
  a.mov(field(offsetof(Cpu, now)), host::rax);
  emit_end();

  a.bind(labels.leave_complete);
  a.mov(host::esi, kGoOn);
  emit_end();

  a.bind(labels.interpret);
  emit_interpret(a);
  const auto access = [&](const asmjit::Label& label, auto* function) {
    a.bind(label);
    emit_access(a, reinterpret_cast<std::uint64_t>(function));
  };
  access(labels.load8, load_register8);
  access(labels.load16, load_register16);
  access(labels.store8, store_register8);
  access(labels.store16, store_register16);
  a.bind(labels.go_elsewhere);
  emit_go_elsewhere(a, labels.leave_complete, entries);
}

}  // namespace kaz::h8s::translate
