// The machine's side of observers: whom to tell, and where the fast paths of accesses lead.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/debug/input_log.h"
#include "sim/h8s/debug/observer.h"

namespace kaz::h8s {
namespace {

// No masked address lies less than a RAM's size above this.
constexpr std::uint32_t kNowhere = 0x80000000;

}  // namespace

void Machine::choose_paths() {
  cpu.observed = !observers.empty();
  cpu.ram_at = cpu.mask & (kBlock + kRam);
  cpu.ram_base = cpu.observed ? kNowhere : cpu.ram_at;
  cpu.quick_flash = cpu.observed || !flash_control.plain() ? 0 : cpu.flash_size;
}

void Machine::attach(Observer& observer) {
  if (std::find(observers.begin(), observers.end(), &observer) == observers.end())
    observers.push_back(&observer);
  choose_paths();
}

void Machine::detach(Observer& observer) {
  std::erase(observers, &observer);
  choose_paths();
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

// Sleep costs no host time: the clock jumps to what comes next.
void Machine::sleep_until(States at) {
  const States from = cpu.now;
  cpu.now = std::max(cpu.now, at);
  if (cpu.now != from)
    for (Observer* o : observers) o->slept(from, cpu.now);
}

}  // namespace kaz::h8s
