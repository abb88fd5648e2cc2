// The machine as a whole: construction, copying, reset, and its links to the CPU core.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/machine.h"

#include <algorithm>
#include <cstdlib>
#include <new>

#include "sim/h8s/chip/observer.h"
#include "sim/h8s/cpu/access.h"

namespace kaz::h8s {
namespace {

// Zero means "not decoded", so fresh pages cost nothing until touched.
Insn* allocate_code() {
  void* p = std::calloc(kCodeSize, sizeof(Insn));
  if (!p) throw std::bad_alloc();
  return static_cast<Insn*>(p);
}

constexpr std::size_t kMaxMisuses = 256;

}  // namespace

void CodeFree::operator()(Insn* p) const {
  std::free(p);
}

Machine::Machine(const Options& chosen)
    : options(chosen), flash_(kFlashSize, 0xff), code_(allocate_code()) {
  attach();
  power_on(0xa5);
}

Machine::Machine(const Machine& other)
    : options(other.options), symbols(other.symbols), flash_(kFlashSize), code_(allocate_code()) {
  take_state(other);
}

void Machine::attach() {
  cpu.bus = this;
  cpu.pending = irq.pending();
  cpu.flash = flash_.data();
  cpu.ram = block_.data() + kRam;
  cpu.has_code = cpu.chip_lines.data() + kRam / kLine;
  cpu.code = code_.get();
  cpu.hooks = !hooks.empty();
  cpu.engine = options.engine;
  cpu.translate_after = options.translate_after;
  if (options.engine == Engine::translator && !translator_) translator_ = make_translator();
  cpu.translated = options.engine == Engine::translator ? translator_.get() : nullptr;
  choose_paths();
  find_frequent();
}

void Machine::take_state(const Machine& other) {
  if (this == &other) return;
  const bool decoded = runs_code_of(other);
  if (!decoded) flash_ = other.flash_;
  block_ = other.block_;
  cpu = other.cpu;
  irq = other.irq;
  ports = other.ports;
  frt = other.frt;
  tmr = other.tmr;
  tmr_xy = other.tmr_xy;
  pwm = other.pwm;
  pwmx = other.pwmx;
  sci = other.sci;
  adc = other.adc;
  wdt = other.wdt;
  flash_control = other.flash_control;
  boot = other.boot;
  dtc = other.dtc;
  system = other.system;
  epoch = other.epoch;
  sub_epoch = other.sub_epoch;
  standby_ = other.standby_;
  watch_ = other.watch_;
  wakes_at_ = other.wakes_at_;
  slow_from_ = other.slow_from_;
  slow_by_ = other.slow_by_;
  cause = other.cause;
  watchdog_reset = other.watchdog_reset;
  misuses = other.misuses;
  dead = other.dead;
  hook_done_ = kNoAddress;
  first_after_reset_ = other.first_after_reset_;
  options = other.options;
  attach();
  // Pointers into the decoded code point to the same place in this machine's.
  const auto moved = [&](const Insn* p) -> const Insn* {
    if (p == nullptr) return nullptr;
    if (p == &other.cpu.outside) return &cpu.outside;
    return cpu.code + (p - other.cpu.code);
  };
  cpu.ip = moved(other.cpu.ip);
  for (std::size_t k = 0; k < kTrail; ++k)
    cpu.trail[k] = {moved(other.cpu.trail[k].from), moved(other.cpu.trail[k].to)};
  if (!decoded) forget_all_code();
  pins.forget(*this, cpu.now);
}

// Decoding and translating the firmware anew costs milliseconds, and what was decoded depends on flash and on
// what is compared here alone. Code in RAM may differ by now, and its lines are in `cpu`.
bool Machine::runs_code_of(const Machine& other) const {
  return !cpu.code_in_ram && !other.cpu.code_in_ram && cpu.mask == other.cpu.mask &&
         cpu.normal == other.cpu.normal && cpu.ram_size == other.cpu.ram_size &&
         cpu.flash_size == other.cpu.flash_size && flash_control.plain() &&
         other.flash_control.plain() && options == other.options && flash_ == other.flash_;
}

void Machine::forget_all_code() {
  const std::uint32_t at =
      cpu.ip == &cpu.outside ? kNoAddress : static_cast<std::uint32_t>(cpu.ip - cpu.code);
  std::array<std::int64_t, 2 * kTrail> places{};
  const auto place = [&](const Insn* p) -> std::int64_t {
    return p == nullptr ? -2 : p == &cpu.outside ? -1 : p - cpu.code;
  };
  for (std::size_t k = 0; k < kTrail; ++k) {
    places[2 * k] = place(cpu.trail[k].from);
    places[2 * k + 1] = place(cpu.trail[k].to);
  }
  if (translator_) translator_->forget_all();
  code_.reset(allocate_code());
  cpu.code = code_.get();
  const auto back = [&](std::int64_t p) -> const Insn* {
    return p == -2 ? nullptr : p == -1 ? &cpu.outside : cpu.code + p;
  };
  for (std::size_t k = 0; k < kTrail; ++k)
    cpu.trail[k] = {back(places[2 * k]), back(places[2 * k + 1])};
  if (at != kNoAddress) cpu.ip = cpu.code + at;
  cpu.chip_lines.fill(0);
  cpu.code_in_ram = false;
}

void Machine::power_on(std::uint8_t ram_fill) {
  boot.leave(*this, cpu.now);
  flash_control.cut(*this, cpu.now);
  block_.fill(ram_fill);
  const std::array<Sci, 2> fresh{};
  sci = fresh;
  cpu.now = cpu.stall = 0;
  cpu.executed = 0;
  if (translator_) translator_->reset_count();
  cpu.er.fill(0);
  misuses.clear();
  reset(ResetCause::power_on, 0);
}

void Machine::reset(ResetCause why, States at) {
  const States began = cpu.now;
  cause = why;
  epoch = sub_epoch = at;
  standby_ = watch_ = false;
  wakes_at_ = slow_from_ = kNever;
  dead.reset();
  watchdog_reset = false;
  cpu.now = at;
  cpu.stall = 0;
  cpu.normal = options.mode == 3;
  cpu.mask = cpu.normal ? 0xffff : 0xffffff;
  cpu.flash_size = cpu.normal ? 0xe000 : kFlashSize;
  cpu.ram_size = kRamSize;
  boot.leave(*this, began);
  flash_control.cut(*this, began);
  choose_paths();
  cpu.exr = 0x7f;
  set_ccr(cpu, options.reset_ccr | CCR::I);
  cpu.two_level = cpu.hold_off = cpu.asleep = cpu.moving = false;
  cpu.fault = Fault::none;
  cpu.stc_copies = options.stc_copies;
  cpu.rte_holds_off = options.rte_holds_off;
  cpu.predecrement_stores_decremented = options.predecrement_stores_decremented;
  cpu.trail = {};
  cpu.jumps = 0;
  irq.reset();
  ports.reset();
  frt = {};
  tmr = {};
  tmr_xy = {};
  pwm = Pwm(epoch);
  pwmx = {};
  wdt = {};
  dtc = {};
  system = {};
  system.mdcr = options.mode & MDCR::MDS;
  const bool boots = options.mode == 0 && ports.pins(*this, 4, at) % 8 == 7;
  if (options.mode == 0 && !boots)
    misuse(
        io::MDCR,
        "mode pins are 0, but P42, P41 and P40 are not all high: boot mode needs these pins high");
  else if (options.mode != 0 && options.mode != 2 && options.mode != 3)
    misuse(io::MDCR, "mode pins select a mode other than 2 and 3: expanded buses are not modeled");
  if (why != ResetCause::watchdog) system.syscr |= SYSCR::XRST;
  if (why == ResetCause::watchdog) system.syscr = SYSCR::RAME;
  adc = {};
  for (unsigned n = 0; n < 2; ++n) sci[n].reset(*this, n, at);
  cpu.ip = cpu.code;
  forget_all_code();
  set_pc(cpu.normal ? big16(flash_.data()) : big32(flash_.data()));
  first_after_reset_ = true;
  if (boots) boot.enter(*this, at);
  find_frequent();
  for (Observer* o : observers) o->was_reset(why, at);
  if (pins.active()) pins.sample(*this, began);
  notify(OutputChange::Unit::port, 0, at);
}

void Machine::set_pc(std::uint32_t address) {
  cpu.ip = record_jump(cpu, nullptr, at_address(cpu, address));
  hook_done_ = kNoAddress;
}

void Machine::misuse(std::uint32_t address, const char* text) {
  if (address - ((kBlock + kIo) & 0xffff) < kIoSize) address |= cpu.mask & 0xff0000;
  const std::uint32_t at = pc();
  const auto same = [&](const Misuse& m) {
    return m.address == address && m.pc == at && m.text == text;
  };
  const auto found = std::find_if(misuses.begin(), misuses.end(), same);
  if (found != misuses.end())
    ++found->count;
  else if (misuses.size() < kMaxMisuses)
    misuses.push_back({address, at, text, 1, time()});
  if (options.stop_on_misuse) raise_fault(cpu, Fault::misuse, address);
}

void Machine::pin_edge(unsigned port, unsigned bit, bool rising, States at) {
  if (standby_) return;  // no clock sees it
  if (port == 4 && bit == 0 && !rising) adc.trigger(*this, 3, at);
  if (port == 5 && bit == 2) sci[0].sck_edge(*this, 0, rising, at);
  if (port == 2 && bit == 7) sci[1].sck_edge(*this, 1, rising, at);
  if (port != 6) return;
  switch (bit) {
    case 0:
      if (rising) frt.clock_edge(*this, at);
      tmr.clock_edge(*this, 0, rising, at);
      tmr_xy.pin_edge(*this, TmrXY::kX, rising, at);
      break;
    case 2:
      frt.capture_edge(*this, 0, rising, at);
      tmr_xy.pin_edge(*this, TmrXY::kY, rising, at);
      break;
    case 3:
      frt.capture_edge(*this, 1, rising, at);
      tmr.reset_edge(*this, 0, rising, at);
      break;
    case 4:
      frt.capture_edge(*this, 2, rising, at);
      break;
    case 5:
      frt.capture_edge(*this, 3, rising, at);
      tmr.clock_edge(*this, 1, rising, at);
      break;
    case 6:
      tmr.reset_edge(*this, 1, rising, at);
      break;
    default:
      break;
  }
}

void Machine::set_hook(std::uint32_t address, Chip::CodeHook hook) {
  hooks[address] = std::move(hook);
  cpu.hooks = true;
  hook_changed(address);
}

void Machine::clear_hook(std::uint32_t address) {
  if (hooks.erase(address) == 0) return;
  cpu.hooks = !hooks.empty();
  hook_changed(address);
}

// The instruction there is decoded again, and translated code that contains it is discarded.
void Machine::hook_changed(std::uint32_t address) {
  const Insn outside = cpu.outside;  // the chip may stand at an address without memory
  Insn* slot = const_cast<Insn*>(at_address(cpu, address));
  if (slot == &cpu.outside) {
    cpu.outside = outside;
    return;
  }
  slot->run = nullptr;
  if (translator_) translator_->hook_changed(static_cast<std::uint32_t>(slot - cpu.code));
}

}  // namespace kaz::h8s
