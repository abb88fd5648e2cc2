// Reports edges at watched pins, in order of time.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/pin_watch.h"

#include <algorithm>

#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
namespace {

// Listeners' reactions may cause further edges; more than this in one state is an oscillation.
constexpr int kMaxRounds = 1000;
// Timer outputs are up to date; those of other modules depend on time alone.
constexpr unsigned kTimerPorts = 1u << 6;

Driver chip_driver(const Machine& m, unsigned port, unsigned bit) {
  const bool out = (m.ports.ddr(port) >> bit & 1) != 0;
  const Driver latch = out ? Driver::port : Driver::nobody;
  if ((port == 2 && bit >= 5) || port == 5) {
    // TxD, RxD, SCK from P25 and from P50 on.
    const Sci& sci = m.sci[port == 5 ? 0 : 1];
    const unsigned role = port == 5 ? bit : bit - 5;
    if (role == 0 ? sci.drives_txd() : role == 2 && sci.drives_sck()) return Driver::sci;
    if (role == 1 ? sci.takes_rxd() : role == 2 && sci.takes_sck()) return Driver::nobody;
  }
  switch (port) {
    case 1:
    case 2:
      if (port == 1 && bit < 2 && m.pwmx.enabled(bit)) return Driver::pwmx;
      if (out && m.pwm.enabled(bit + (port == 2 ? 8 : 0))) return Driver::pwm;
      return latch;
    case 4:
      return bit == 6 && out ? Driver::clock : latch;
    case 6:
      if ((bit == 1 && m.frt.drives(0)) || (bit == 6 && m.frt.drives(1))) return Driver::frt;
      if (bit == 7 && m.tmr_xy.drives()) return Driver::tmr;
      if ((bit == 4 && m.tmr.drives(0)) || (bit == 7 && m.tmr.drives(1))) return Driver::tmr;
      return latch;
    default:
      return latch;
  }
}

PinState control_pin(const Machine& m, Pin pin) {
  switch (pin) {
    case Pin::nmi:
      return {m.irq.nmi_level(), Driver::board, false};
    case Pin::md0:
      return {(m.options.mode & MDCR::MDS0) != 0, Driver::board, false};
    case Pin::md1:
      return {(m.options.mode & MDCR::MDS1) != 0, Driver::board, false};
    default:  // RES and STBY: a chip that runs has them high
      return {true, Driver::board, false};
  }
}

}  // namespace

PinState pin_state(const Machine& m, Pin pin, States at) {
  const PinInfo& p = info(pin);
  if (p.port == 0) return control_pin(m, pin);
  const auto port = static_cast<unsigned>(p.port), bit = static_cast<unsigned>(p.bit);
  PinState s;
  s.pull_up = m.ports.pulled_up(port, bit);
  s.driver = chip_driver(m, port, bit);
  if (s.driver == Driver::nobody)
    s.driver = m.ports.given(port, bit) ? Driver::board
               : s.pull_up              ? Driver::pull_up
                                        : Driver::nobody;
  s.level = (m.ports.pins(m, port, at) >> bit & 1) != 0;
  return s;
}

States next_pin_change(const Machine& m, Pin pin, States at) {
  const PinInfo& p = info(pin);
  if (p.port == 0) return kNever;
  const auto port = static_cast<unsigned>(p.port), bit = static_cast<unsigned>(p.bit);
  switch (chip_driver(m, port, bit)) {
    case Driver::pwm:
      return m.pwm.next_change(bit + (port == 2 ? 8 : 0), at, m.options.pwm_right_aligned);
    case Driver::pwmx:
      return m.pwmx.next_change(bit, at, m.options.pwmx_data_is_low);
    case Driver::sci:
      return bit == 0 || bit == 5 ? m.sci[port == 5 ? 0 : 1].txd_change(at)
                                  : m.sci[port == 5 ? 0 : 1].sck_change(at);
    case Driver::frt:
      return m.stopped(kStopFrt) ? kNever : m.frt.next_change(m.epoch, bit == 1 ? 0 : 1);
    case Driver::tmr:
      if (bit == 7 && m.tmr_xy.drives())
        return m.stopped(kStopTmrxy) ? kNever : m.tmr_xy.next_change(m);
      return m.stopped(kStopTmr) ? kNever : m.tmr.next_change(m, bit == 4 ? 0 : 1);
    default:
      return kNever;
  }
}

int PinWatch::watch(const Machine& m, Pin pin, PinListener listener, bool drivers, States at) {
  watched_.push_back({next_id_, pin, pin_state(m, pin, at), drivers, std::move(listener)});
  find_ports();
  sampled_ = std::max(sampled_, at);
  return next_id_++;
}

void PinWatch::unwatch(int id) {
  std::erase_if(watched_, [id](const Watched& w) { return w.id == id; });
  find_ports();
}

void PinWatch::find_ports() {
  ports_ = 0;
  for (const Watched& w : watched_) ports_ |= 1u << info(w.pin).port;
}

int PinWatch::call_at(States at, std::function<void(States)> call) {
  calls_.insert({at, {next_id_, std::move(call)}});
  return next_id_++;
}

void PinWatch::cancel(int id) {
  std::erase_if(calls_, [id](const auto& c) { return c.second.id == id; });
}

States PinWatch::next_event(const Machine& m) const {
  States first = calls_.empty() ? kNever : calls_.begin()->first;
  Pin last = Pin::md1;
  for (const Watched& w : watched_) {
    if (w.pin != last) first = std::min(first, next_pin_change(m, w.pin, sampled_));
    last = w.pin;
  }
  return first;
}

void PinWatch::advance(Machine& m, States to) {
  sample(m, to);
  while (!calls_.empty() && calls_.begin()->first <= to) {
    const Call call = std::move(calls_.begin()->second);
    calls_.erase(calls_.begin());
    call.call(to);
    sample(m, to);
  }
}

bool PinWatch::report_once(Machine& m, States at) {
  bool reported = false;
  // By index: a listener may add watches. If one removes itself, the next one is reported in the next pass.
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    Watched& w = watched_[k];
    const PinState now = pin_state(m, w.pin, at);
    const bool edge = now.level != w.last.level || (w.drivers && now != w.last);
    w.last = now;
    if (!edge) continue;
    reported = true;
    const PinListener listener = w.listener;
    listener({w.pin, now.level, now.driver, at});
  }
  return reported;
}

void PinWatch::sample(Machine& m, States at) {
  if (watched_.empty()) {
    sampled_ = at;
    return;
  }
  if (reporting_) return;  // the pass in progress will report it
  reporting_ = true;
  if (watches(kTimerPorts)) m.advance_outputs(at);
  int rounds = 0;
  while (report_once(m, at) && ++rounds < kMaxRounds) {
  }
  reporting_ = false;
  if (rounds == kMaxRounds)
    m.misuse(0, "the pins do not settle: each change immediately causes another change");
  sampled_ = at;
}

void PinWatch::forget(const Machine& m, States at) {
  for (Watched& w : watched_) w.last = pin_state(m, w.pin, at);
  sampled_ = at;
}

}  // namespace kaz::h8s
