// The inner loop while somebody looks on: each instruction and each access is told.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/machine.h"
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/cpu.h"
#include "sim/h8s/debug/observer.h"

namespace kaz::h8s {

Flow flow_of(std::uint16_t first_word) {
  const unsigned high = first_word >> 8;
  if ((high & 0xf0) == 0x40) return high < 0x42 ? Flow::jump : Flow::branch;
  switch (high) {
    case 0x58:
      return (first_word & 0xff) < 0x20 ? Flow::jump : Flow::branch;
    case 0x55:
    case 0x5c:
    case 0x5d:
    case 0x5e:
    case 0x5f:
      return Flow::call;
    case 0x59:
    case 0x5a:
    case 0x5b:
      return Flow::jump;
    case 0x54:
      return Flow::back;
    case 0x56:
      return Flow::exit;
    case 0x57:
      return Flow::trap;
    case 0x01:
      return first_word == 0x0180 ? Flow::sleep : Flow::plain;
    default:
      return Flow::plain;
  }
}

void observe_access(Cpu& c, std::uint32_t address, unsigned size, unsigned value, bool write) {
  const Access access{address & c.mask,
                      pc_of(c, c.ip),
                      static_cast<std::uint16_t>(value),
                      static_cast<std::uint8_t>(size),
                      write,
                      c.machine->time()};
  for (Observer* o : c.machine->observers) o->accessed(access);
}

void run_observed(Cpu& c) {
  Machine& m = *c.machine;
  while (c.now < c.stop) {
    const std::uint32_t pc = pc_of(c, c.ip);
    if (c.hooks && hooked_here(c, pc)) return end_stretch(c);
    const Insn* ip = c.ip;
    Handler run = ip->run;
    if (c.engine == Engine::reference)
      run = decode_afresh(c, ip);
    else if (!run)
      run = decode_in_place(c, ip);
    Executed done;
    done.pc = pc;
    done.begin = c.now + c.stall;
    for (Observer* o : m.observers) o->before(pc, done.begin);
    const std::uint8_t* code = m.memory_at(pc);
    if (code) done.word = big16(code);
    done.flow = flow_of(done.word);
    done.length = static_cast<std::uint8_t>(2 * ip->units);
    c.now += ip->states;
    c.ip = run(c, ip);
    ++c.executed;
    done.end = c.now + c.stall;
    done.next = pc_of(c, c.ip);
    done.whole = !c.moving;
    for (Observer* o : m.observers) o->executed(done);
  }
}

}  // namespace kaz::h8s
