// The inner loops of the reference engine and of the interpreter, and the choice between engines.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/cpu/cpu.h"

namespace kaz::h8s {

const char* name_of(Engine engine) {
  switch (engine) {
    case Engine::reference:
      return "reference";
    case Engine::interpreter:
      return "interpreter";
    case Engine::translator:
      break;
  }
  return "translator";
}

void run_reference(Cpu& c) {
  while (c.now < c.stop) {
    const Handler run = decode_afresh(c, c.ip);
    c.now += c.ip->states;
    c.ip = run(c, c.ip);
    ++c.executed;
  }
}

void run_interpreter(Cpu& c) {
  const Insn* ip = c.ip;
  States now = c.now;
  std::int64_t executed = 0;
  while (now < c.stop) {
    Handler run = ip->run;
    if (!run) [[unlikely]]
      run = decode_in_place(c, ip);
    now += ip->states;
    c.now = now;
    c.ip = ip;
    ip = run(c, ip);
    ++executed;
  }
  c.ip = ip;
  c.executed += executed;
}

void run_stretch(Cpu& c) {
  if (c.observed)
    c.bus->run_observed();
  else if (c.engine == Engine::reference)
    run_reference(c);
  else if (c.translated && !c.normal)
    c.translated->run(c);
  else
    run_interpreter(c);
}

}  // namespace kaz::h8s
