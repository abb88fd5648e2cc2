// PWM and timer output pins as the board sees them: the pin's owner and its mean level.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

struct PortPin {
  unsigned port, bit;
};
PortPin pw_pin(int channel) {
  const auto n = static_cast<unsigned>(channel);
  return {n < 8 ? 1u : 2u, n & 7};
}
// TMO0 is P64, TMO1 is P67.
PortPin tmo_pin(int timer) {
  return {6, timer == 0 ? 4u : 7u};
}

}  // namespace

bool Machine::pw_driven(int channel) const {
  if (channel < 0 || channel > 15) return false;
  const PortPin pin = pw_pin(channel);
  return (ports.ddr(pin.port) >> pin.bit & 1) != 0 || serial_drives(channel);
}

// TxD1 shares its pin with PW13.
bool Machine::serial_drives(int channel) const {
  return channel == 13 && sci[1].drives_txd();
}

int Machine::pw_high_counts(int channel) const {
  if (channel < 0 || channel > 15) return 0;
  const PortPin pin = pw_pin(channel);
  const bool serial = serial_drives(channel);
  if (!(ports.ddr(pin.port) >> pin.bit & 1) && !serial) return 0;
  if (pwm.enabled(static_cast<unsigned>(channel)) && !serial)
    return pwm.high_counts(static_cast<unsigned>(channel), time());
  return ports.output(*this, pin.port, time()).level >> pin.bit & 1 ? 256 : 0;
}

bool Machine::tmo_driven(int timer) const {
  if (timer < 0 || timer > 1) return false;
  const PortPin pin = tmo_pin(timer);
  return tmr.drives(static_cast<unsigned>(timer)) || (ports.ddr(pin.port) >> pin.bit & 1) != 0;
}

double Machine::tmo_high_share(int timer) {
  if (!tmo_driven(timer)) return 0;
  const PortPin pin = tmo_pin(timer);
  if (!tmr.drives(static_cast<unsigned>(timer))) return ports.dr(pin.port) >> pin.bit & 1;
  tmr.advance(*this, time());
  return tmr.high_share(*this, static_cast<unsigned>(timer));
}

}  // namespace kaz::h8s
