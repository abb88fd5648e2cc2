// The machine's side of observers: registration, notification, and the execution loop while observed.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/chip/observer.h"
#include "sim/h8s/cpu/access.h"

namespace kaz::h8s {
namespace {

// Beyond all masked addresses by more than the size of any RAM.
constexpr std::uint32_t kNowhere = 0x80000000;

}  // namespace

Flow flow_of(std::uint16_t first_word) {
  const unsigned high = first_word >> 8;
  if (high >> 4 == 0x4) return high < 0x42 ? Flow::jump : Flow::branch;
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

void Machine::choose_paths() {
  cpu.observed = !observers.empty();
  cpu.ram_at = cpu.mask & (kBlock + kRam);
  cpu.ram_base = cpu.observed ? kNowhere : cpu.ram_at;
  cpu.quick_flash = cpu.observed || !flash_control.plain() ? 0 : cpu.flash_size;
}

void Machine::attach(Observer& observer) {
  convert_all();
  if (std::find(observers.begin(), observers.end(), &observer) == observers.end())
    observers.push_back(&observer);
  choose_paths();
  reschedule_all();
}

void Machine::detach(Observer& observer) {
  convert_all();
  std::erase(observers, &observer);
  choose_paths();
  reschedule_all();
}

void Machine::request_stop() {
  stop_requested_ = true;
  end_stretch(cpu);
}

void Machine::memory_changed(std::uint32_t address, std::uint32_t size) {
  for (Observer* o : observers) o->changed(address, size);
}

void Machine::log_input(std::function<void(Chip&)> apply) {
  if (!input_log) return;
  if (running && !in_hook)
    input_log->cut();
  else
    input_log->input(std::move(apply));
}

void Machine::log_cut() {
  if (input_log) input_log->cut();
}

void Machine::connect_analog() {
  listeners.analog = analog_source;
  if (!input_log || !analog_source) return;
  listeners.analog = [this](int channel, States at) {
    const double value = analog_source(channel, at);
    input_log->sampled(channel, at, value);
    return value;
  };
}

// Sleep takes no host time: the clock advances to the next event.
void Machine::sleep_until(States at) {
  const States from = cpu.now;
  cpu.now = std::max(cpu.now, at);
  if (cpu.now != from)
    for (Observer* o : observers) o->slept(from, cpu.now);
}

void Machine::notify_access(std::uint32_t address, unsigned size, unsigned value, bool write) {
  const Access access{address & cpu.mask,
                      pc(),
                      static_cast<std::uint16_t>(value),
                      static_cast<std::uint8_t>(size),
                      write,
                      time()};
  for (Observer* o : observers) o->accessed(access);
}

void Machine::run_observed() {
  Cpu& c = cpu;
  while (c.now < c.stop) {
    const std::uint32_t pc = pc_of(c, c.ip);
    if (c.hooks && hook_due(pc)) return end_stretch(c);
    const Insn* ip = c.ip;
    Handler handler = ip->run;
    if (c.engine == Engine::reference)
      handler = decode_afresh(c, ip);
    else if (!handler)
      handler = decode_in_place(c, ip);
    Executed done;
    done.pc = pc;
    done.begin = c.now + c.stall;
    for (Observer* o : observers) o->before(pc, done.begin);
    const std::uint8_t* code = memory_at(pc);
    if (code) done.word = big16(code);
    done.flow = flow_of(done.word);
    done.length = static_cast<std::uint8_t>(2 * ip->units);
    c.now += ip->states;
    c.ip = handler(c, ip);
    ++c.executed;
    done.end = c.now + c.stall;
    done.next = pc_of(c, c.ip);
    done.whole = !c.moving;
    for (Observer* o : observers) o->executed(done);
  }
}

}  // namespace kaz::h8s
