// The chip's pins: looking, watching, driving.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "sim/h8s/chip.h"
#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {

PinState Chip::state(Pin pin) const {
  const States at = machine_->moment();
  machine_->bring_outputs_to(at);
  return pin_state(*machine_, pin, at);
}

int Chip::watch(Pin pin, PinListener listener, bool drivers) {
  const States at = machine_->moment();
  machine_->bring_outputs_to(at);
  const int id = machine_->pins.watch(*machine_, pin, std::move(listener), drivers, at);
  machine_->disturbed();
  return id;
}

void Chip::unwatch(int watch) {
  machine_->pins.unwatch(watch);
}

int Chip::call_at(States at, std::function<void(States)> call) {
  const int id = machine_->pins.call_at(std::max(at, machine_->moment()), std::move(call));
  machine_->disturbed();
  return id;
}

void Chip::cancel(int call) {
  machine_->pins.cancel(call);
  machine_->disturbed();
}

void Chip::set_input(Pin pin, bool level) {
  machine_->log_input([=](Chip& c) { c.set_input(pin, level); });
  const PinInfo& p = info(pin);
  if (p.port != 0)
    machine_->set_input(static_cast<unsigned>(p.port), static_cast<unsigned>(p.bit), level);
  if (pin == Pin::nmi) machine_->set_nmi(level);
}

void Chip::release_input(Pin pin) {
  machine_->log_input([=](Chip& c) { c.release_input(pin); });
  const PinInfo& p = info(pin);
  if (p.port != 0)
    machine_->set_input(static_cast<unsigned>(p.port), static_cast<unsigned>(p.bit), std::nullopt);
}

}  // namespace kaz::h8s
