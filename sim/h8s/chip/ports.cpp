// Ports: levels at the pins and the registers behind them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/ports.h"

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

enum class Kind { ddr, dr, pcr, pins };
struct PortRegister {
  Kind kind;
  unsigned port;
};

std::optional<PortRegister> port_register(std::uint32_t address) {
  switch (address) {
    case io::P1PCR:
      return PortRegister{Kind::pcr, 1};
    case io::P2PCR:
      return PortRegister{Kind::pcr, 2};
    case io::P3PCR:
      return PortRegister{Kind::pcr, 3};
    case io::P1DDR:
      return PortRegister{Kind::ddr, 1};
    case io::P2DDR:
      return PortRegister{Kind::ddr, 2};
    case io::P1DR:
      return PortRegister{Kind::dr, 1};
    case io::P2DR:
      return PortRegister{Kind::dr, 2};
    case io::P3DDR:
      return PortRegister{Kind::ddr, 3};
    case io::P4DDR:
      return PortRegister{Kind::ddr, 4};
    case io::P3DR:
      return PortRegister{Kind::dr, 3};
    case io::P4DR:
      return PortRegister{Kind::dr, 4};
    case io::P5DDR:
      return PortRegister{Kind::ddr, 5};
    case io::P6DDR:
      return PortRegister{Kind::ddr, 6};
    case io::P5DR:
      return PortRegister{Kind::dr, 5};
    case io::P6DR:
      return PortRegister{Kind::dr, 6};
    case io::P7PIN:
      return PortRegister{Kind::pins, 7};
    default:
      return std::nullopt;
  }
}

// Bits that exist.
constexpr std::uint8_t width(unsigned port) {
  return port == 5 ? static_cast<std::uint8_t>(~P5DR::ONE) : 0xff;
}

}  // namespace

void Ports::reset() {
  ddr_ = dr_ = pcr_ = {};
}

PortOutput Ports::output(const Machine& m, unsigned port, States at) const {
  PortOutput out{dr_[port], ddr_[port]};
  const auto own = [&out](unsigned bit, bool level) {
    const auto mask = static_cast<std::uint8_t>(1u << bit);
    out.driven = static_cast<std::uint8_t>(out.driven | mask);
    out.level = static_cast<std::uint8_t>(level ? out.level | mask : out.level & ~mask);
  };
  // A pin that the channel uses as an input is not driven, regardless of its direction bit.
  const auto serial = [&](const Sci& sci, unsigned txd, unsigned rxd, unsigned sck) {
    if (sci.drives_txd()) own(txd, sci.txd(at));
    if (sci.drives_sck()) own(sck, sci.sck(at));
    const unsigned in = (sci.takes_rxd() ? 1u << rxd : 0u) | (sci.takes_sck() ? 1u << sck : 0u);
    out.driven = static_cast<std::uint8_t>(out.driven & ~in);
  };
  if (port == 1 || port == 2) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      const unsigned channel = bit + (port == 2 ? 8 : 0);
      if ((ddr_[port] >> bit & 1) && m.pwm.enabled(channel))
        own(bit, m.pwm.level(channel, at, m.options.pwm_right_aligned));
    }
    if (port == 1) {
      for (unsigned n = 0; n < 2; ++n) {
        if (m.pwmx.enabled(n)) own(n, m.pwmx.level(n, at, m.options.pwmx_data_is_low));
      }
    }
    if (port == 2) serial(m.sci[1], 5, 6, 7);
  } else if (port == 4) {
    if (ddr_[4] & P4DDR::P46DDR) own(6, false);  // the clock itself, not a level
  } else if (port == 5) {
    serial(m.sci[0], 0, 1, 2);
  } else if (port == 6) {
    if (m.frt.drives(0)) own(1, m.frt.level(0));
    if (m.frt.drives(1)) own(6, m.frt.level(1));
    if (m.tmr.drives(0)) own(4, m.tmr.level(0));
    if (m.tmr.drives(1)) own(7, m.tmr.level(1));
    if (m.tmr_xy.drives()) own(7, m.tmr_xy.level());
  }
  out.driven &= width(port);
  out.level &= out.driven;
  return out;
}

std::uint8_t Ports::pins(const Machine& m, unsigned port, States at) const {
  const PortOutput out = output(m, port, at);
  const auto pulled = static_cast<std::uint8_t>(pcr_[port] | (m.options.floating_level ? 0xff : 0));
  const auto outside =
      static_cast<std::uint8_t>((level_[port] & given_[port]) | (pulled & ~given_[port]));
  return static_cast<std::uint8_t>(out.level | (outside & ~out.driven));
}

void Ports::set_input(Machine& m, unsigned port, unsigned bit, std::optional<bool> level,
                      States at) {
  const auto mask = static_cast<std::uint8_t>(1u << bit);
  const std::uint8_t before = pins(m, port, at);
  given_[port] = static_cast<std::uint8_t>(level ? given_[port] | mask : given_[port] & ~mask);
  level_[port] =
      static_cast<std::uint8_t>(level.value_or(false) ? level_[port] | mask : level_[port] & ~mask);
  const std::uint8_t after = pins(m, port, at);
  const bool now_high = (after & mask) != 0;
  if ((port == 5 && bit == 1) || (port == 2 && bit == 6)) {
    const unsigned n = port == 5 ? 0 : 1;
    m.sci[n].rxd_edge(m, n, now_high, level.has_value(), at);
  }
  if (port == 4 && bit <= 2) m.irq.set_irq_pin(2 - bit, now_high, at);
  if ((before ^ after) & mask) m.pin_edge(port, bit, now_high, at);
}

std::optional<std::uint8_t> Ports::read(const Machine& m, std::uint32_t address) const {
  const auto r = port_register(address);
  if (!r) return std::nullopt;
  const unsigned port = r->port;
  const States at = m.time();
  switch (r->kind) {
    case Kind::pcr:
      return pcr_[port];
    case Kind::ddr:
      return m.options.undefined_read;
    case Kind::pins:
      return pins(m, port, at);
    case Kind::dr: {
      std::uint8_t ddr = ddr_[port];
      if (port == 4) ddr &= ~P4DDR::P46DDR;  // P46 reads the pin
      const auto mixed = static_cast<std::uint8_t>((dr_[port] & ddr) | (pins(m, port, at) & ~ddr));
      return static_cast<std::uint8_t>((mixed & width(port)) | (0xff & ~width(port)));
    }
  }
  return std::nullopt;
}

bool Ports::holds(std::uint32_t address, std::uint8_t value) const {
  const auto r = port_register(address);
  if (!r || (r->kind != Kind::dr && r->kind != Kind::ddr)) return false;
  return (r->kind == Kind::dr ? dr_ : ddr_)[r->port] == (value & width(r->port));
}

bool Ports::write(Machine& m, std::uint32_t address, std::uint8_t value, States at) {
  const auto r = port_register(address);
  if (!r) return false;
  if (r->kind == Kind::pins) {
    m.misuse(address, "write to P7PIN: port 7 is input only");
    return true;
  }
  auto& bank = r->kind == Kind::ddr ? ddr_ : r->kind == Kind::dr ? dr_ : pcr_;
  const auto kept = static_cast<std::uint8_t>(value & width(r->port));
  if (bank[r->port] == kept) return true;
  bank[r->port] = kept;
  if (r->kind != Kind::pcr) m.notify(OutputChange::Unit::port, static_cast<int>(r->port), at);
  return true;
}

}  // namespace kaz::h8s
