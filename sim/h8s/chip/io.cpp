// Register addresses: modules, module stop, register banks, reads without side effects.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/machine.h"

namespace kaz::h8s {
enum class Unit : std::uint8_t {
  none,
  absent,
  interrupts,
  system,
  ports,
  frt,
  tmr,
  tmr_xy,
  pwm,
  pwmx,
  sci,
  adc,
  wdt,
  flash,
  pwm_clock,
  dtc
};

// Which module a register belongs to.
struct Place {
  Unit unit = Unit::none;
  std::int8_t stop = -1;  // bit of MSTPCR
  std::uint8_t n = 0;     // channel
};

namespace {

constexpr bool within(std::uint32_t a, std::uint32_t first, std::uint32_t last) {
  return a >= first && a <= last;
}

// Resolves the register banks selected by STCR, TCONRS and others (hardware manual, register list).
constexpr Place find_place(std::uint32_t a, std::uint8_t stcr) {
  const bool iice = (stcr & STCR::IICE) != 0, flshe = (stcr & STCR::FLSHE) != 0;
  if (a == io::KBCOMP) return {Unit::adc, kStopAdc};
  if (within(a, io::ICRA, io::ISCRL) || within(a, io::ABRKCR, io::BARC) || a == io::IER)
    return {Unit::interrupts};
  if (within(a, io::FLMCR1, io::MSTPCRL)) {
    if (flshe) return {a <= io::EBR2 ? Unit::flash : Unit::none};
    if (a == io::PCSR) return {Unit::pwm_clock, kStopPwm};
    return {a >= io::SYSCR2 ? Unit::system : Unit::none};
  }
  if (within(a, io::SMR1, io::ICMR1) || within(a, io::SMR0, io::ICMR0)) {
    const std::uint8_t n = a >= io::SMR0 ? 0 : 1, offset = a % 8;
    const bool iic = iice && (offset <= Sci::kBrr || offset >= Sci::kScmr);
    if (iic || offset > Sci::kScmr) return {Unit::absent};
    return {Unit::sci, n == 0 ? std::int8_t{kStopSci0} : std::int8_t{kStopSci1}, n};
  }
  if (within(a, io::TIER, io::ICRD16 + 1)) return {Unit::frt, kStopFrt};
  if (within(a, io::WTCSR0, io::WTCNT0)) return {Unit::wdt, -1, 0};
  if (within(a, io::WTCSR1, io::WTCNT1)) return {Unit::wdt, -1, 1};
  if (within(a, io::P1PCR, io::P3PCR) || within(a, io::P1DDR, io::P6DR) || a == io::P7PIN)
    return {Unit::ports};
  if (within(a, io::STCR, io::WSCR)) return {Unit::system};
  if (within(a, io::TCR0, io::TCNT1)) return {Unit::tmr, kStopTmr};
  if (within(a, io::TCRX, io::TCORBX) || within(a, io::TCONRI, io::SEDGR))
    return {Unit::tmr_xy, kStopTmrxy};
  if (iice && (within(a, io::DADRA, io::DADRA + 1) || within(a, io::DADRB, io::DADRB + 1)))
    return {Unit::pwmx, kStopPwm};
  if (within(a, io::PWOERB, io::PWDR)) return {Unit::pwm, kStopPwm};
  if (within(a, io::ADDRA, io::ADCR)) return {Unit::adc, kStopAdc};
  if (within(a, io::DTCERA, io::DTVECR)) return {Unit::dtc, kStopDtc};
  if (a == io::DDCSWR) return {Unit::absent};
  return {};
}

// The same as a table: FE00..FFFF for each combination of STCR's bank bits.
constexpr unsigned kBankShift = std::countr_zero(STCR::FLSHE), kBanks = 4;
constexpr std::uint32_t kPlaces = 0x200, kFirstPlace = 0x10000 - kPlaces;

constexpr auto make_places() {
  std::array<std::array<Place, kPlaces>, kBanks> places{};
  for (std::uint32_t bank = 0; bank < kBanks; ++bank) {
    for (std::uint32_t k = 0; k < kPlaces; ++k)
      places[bank][k] = find_place(kFirstPlace + k, static_cast<std::uint8_t>(bank << kBankShift));
  }
  return places;
}
constexpr auto kAllPlaces = make_places();

const Place& place_of(std::uint32_t a, std::uint8_t stcr) {
  return kAllPlaces[stcr >> kBankShift & (kBanks - 1)][a & (kPlaces - 1)];
}

Source source_of(const Place& p) {
  switch (p.unit) {
    case Unit::sci:
      return p.n == 0 ? Source::sci0 : Source::sci1;
    case Unit::wdt:
      return p.n == 0 ? Source::wdt0 : Source::wdt1;
    case Unit::adc:
      return Source::adc;
    case Unit::frt:
      return Source::frt;
    case Unit::tmr_xy:
      return Source::tmr_xy;
    default:
      return Source::tmr;
  }
}

// Ports whose pins the module may drive or read, bit n: port n. Ports, module stop and others: all.
unsigned ports_of(const Place& p) {
  switch (p.unit) {
    case Unit::frt:
    case Unit::tmr:
    case Unit::tmr_xy:
      return 1u << 6;
    case Unit::pwm:
    case Unit::pwmx:
      return 1u << 1 | 1u << 2;
    case Unit::sci:
      return p.n == 0 ? 1u << 5 : 1u << 2;
    case Unit::adc:
    case Unit::wdt:
      return 0;
    default:
      return ~0u;
  }
}

}  // namespace

// Requests that an access has raised end the stretch.
inline void Machine::check_raised() {
  if (irq.take_raised() && (irq.any_unmasked(cpu.control, cpu.two_level) || irq.any_diverted()))
    end_stretch(cpu);
}

void Machine::process_events(States to) {
  if (processing_ == kNever) run_events(to);
  check_raised();
}

inline void Machine::sample_pins(unsigned of_ports) {
  if (!pins.watches(of_ports)) return;
  pins.sample(*this, event_time());
  rescheduled(Source::pins);
}

// What must be rescheduled after an access: nothing, the module's next event, or all modules.
void Machine::accessed(const Place& p, std::uint32_t a, States at, bool written) {
  switch (p.unit) {
    case Unit::frt:
    case Unit::tmr:
    case Unit::tmr_xy:
    case Unit::adc:
    case Unit::sci:
    case Unit::wdt:
      // Reading only brings a module up to date.
      if (const Source source = source_of(p); written || due(source, at)) rescheduled(source);
      break;
    case Unit::ports:
      // Port 6 is where timers count and capture.
      if (written && (a == io::P6DDR || a == io::P6DR)) reschedule_all();
      break;
    case Unit::none:
    case Unit::absent:
    case Unit::pwm:
    case Unit::pwm_clock:
    case Unit::pwmx:
      break;
    default:
      if (written) reschedule_all();
      break;
  }
  if (written) sample_pins(ports_of(p));
  check_raised();
}

// Modules on the 16-bit internal bus.
bool Machine::wide(std::uint32_t address) const {
  const Unit unit = place_of(address & 0xffff, system.stcr).unit;
  return options.wide_timer_bus &&
         (unit == Unit::frt || unit == Unit::tmr || unit == Unit::tmr_xy || unit == Unit::wdt);
}

bool Machine::module_stopped(const Place& p) const {
  return p.stop >= 0 && stopped(static_cast<unsigned>(p.stop));
}

void Machine::find_frequent() {
  for (std::uint32_t k = 0; k < kPlaces; ++k) {
    const Place& p = kAllPlaces[system.stcr >> kBankShift & (kBanks - 1)][k];
    Frequent& f = frequent_[k] = Frequent::none;
    if (module_stopped(p)) continue;
    if (p.unit == Unit::adc) f = Frequent::adc;
    if (p.unit == Unit::pwm) f = Frequent::pwm;
    if (p.unit == Unit::ports) f = Frequent::ports;
    if (p.unit == Unit::sci) f = p.n == 0 ? Frequent::sci0 : Frequent::sci1;
  }
}

inline std::uint8_t Machine::io_read_at(std::uint32_t address, States at) {
  settle(at);
  // What is due while an event is processed is rescheduled below.
  switch (frequent_[address & (kPlaces - 1)]) {
    case Frequent::adc:
      if (due(Source::adc, at)) break;
      adc.advance(*this, at);
      return adc.read_now(address & 0xffff);
    case Frequent::sci0:
      if (due(Source::sci0, at)) break;
      return sci[0].read_now(address % 8);
    case Frequent::sci1:
      if (due(Source::sci1, at)) break;
      return sci[1].read_now(address % 8);
    default:
      break;
  }
  const Place& p = place_of(address & 0xffff, system.stcr);
  const std::uint8_t value = read_register(p, address, at);
  accessed(p, address & 0xffff, at, false);
  return value;
}

std::uint8_t Machine::io_read(std::uint32_t address) {
  return io_read_at(address, time());
}

std::uint8_t Machine::load_io8(std::uint32_t address) {
  add_stall(cpu, 1);
  return io_read_at(address, time());
}

std::uint16_t Machine::load_io16(std::uint32_t address) {
  add_stall(cpu, 1);
  const Frequent frequent = frequent_[address & (kPlaces - 1)];
  const unsigned high = io_read_at(address, time());
  if (frequent != Frequent::none || !wide(address)) add_stall(cpu, 2);
  // The lower byte of a result was latched with the upper one.
  if (frequent == Frequent::adc && within(address & 0xffff, io::ADDRA, io::ADDRD + 1))
    return static_cast<std::uint16_t>(high << 8 | adc.read_now((address + 1) & 0xffff));
  return static_cast<std::uint16_t>(high << 8 | io_read_at(address + 1, time()));
}

void Machine::store_io8(std::uint32_t address, std::uint8_t value) {
  add_stall(cpu, 1);
  io_write_at(address, value, time());
}

void Machine::store_io16(std::uint32_t address, std::uint16_t value) {
  add_stall(cpu, wide(address) ? 1 : 3);
  io_write_word(address, value);
}

void Machine::io_write(std::uint32_t address, std::uint8_t value) {
  io_write_at(address, value, time());
}

inline void Machine::io_write_at(std::uint32_t address, std::uint8_t value, States at) {
  settle(at - 1);
  switch (frequent_[address & (kPlaces - 1)]) {
    case Frequent::adc:
      adc.write(*this, address & 0xffff, value, at);
      rescheduled(Source::adc, adc_event());
      return check_raised();
    case Frequent::pwm:
      if (pwm.write_quietly(address & 0xffff, value)) return;
      pwm.write(*this, address & 0xffff, value, at);
      return sample_pins(1u << 1 | 1u << 2);
    case Frequent::ports:
      if (ports.holds(address & 0xffff, value)) return;
      break;
    case Frequent::sci0:
      sci[0].write(*this, 0, address % 8, value, at);
      rescheduled(Source::sci0, sci[0].next_event());
      sample_pins(1u << 5);
      return check_raised();
    case Frequent::sci1:
      sci[1].write(*this, 1, address % 8, value, at);
      rescheduled(Source::sci1, sci[1].next_event());
      sample_pins(1u << 2);
      return check_raised();
    case Frequent::none:
      break;
  }
  const Place& p = place_of(address & 0xffff, system.stcr);
  write_register(p, address & 0xffff, value, at);
  accessed(p, address & 0xffff, at, true);
}

std::uint8_t Machine::read_register(const Place& p, std::uint32_t address, States at) {
  const std::uint32_t a = address & 0xffff;
  if (module_stopped(p)) {
    misuse(a, "read of a register whose module is stopped (MSTPCR)");
    return options.undefined_read;
  }
  switch (p.unit) {
    case Unit::interrupts:
      return irq.read(a).value_or(options.undefined_read);
    case Unit::dtc:
      return dtc.read(a);
    case Unit::frt:
      return frt.read(*this, a, at);
    case Unit::tmr:
      return tmr.read(*this, a, at);
    case Unit::tmr_xy:
      return tmr_xy.read(*this, a, at);
    case Unit::pwmx:
      return pwmx.read(a, at);
    case Unit::sci:
      return sci[p.n].read(*this, p.n, a % 8, at);
    case Unit::adc:
      return adc.read(*this, a, at);
    case Unit::wdt:
      return wdt[p.n].read(*this, p.n, (a & 1) != 0, at);
    case Unit::absent:
      misuse(a, "read of a register of a module that is not emulated");
      break;
    case Unit::none:
      misuse(a, "read of an address without a register");
      break;
    case Unit::ports:
      if (within(a, io::P1DDR, io::P6DDR) && !within(a, io::P1DR, io::P2DR) &&
          !within(a, io::P3DR, io::P4DR))
        misuse(a, "read of a data direction register, which is write-only");
      break;
    default:
      break;
  }
  return io_peek(address).value_or(options.undefined_read);
}

std::optional<std::uint8_t> Machine::io_peek(std::uint32_t address) {
  const std::uint32_t a = address & 0xffff;
  const Place& p = place_of(a, system.stcr);
  switch (p.unit) {
    case Unit::interrupts:
      return irq.peek(a);
    case Unit::ports:
      if (a == io::P6DR) advance_outputs(time());
      return ports.read(*this, a);
    case Unit::frt:
      frt.advance(*this, time());
      return frt.peek(a);
    case Unit::tmr:
      tmr.advance(*this, time());
      return tmr.peek(a);
    case Unit::tmr_xy:
      tmr_xy.advance(*this, time());
      return tmr_xy.peek(a);
    case Unit::pwmx:
      return pwmx.peek(a, time());
    case Unit::pwm:
    case Unit::pwm_clock:
      return pwm.peek(a);
    case Unit::sci:
      return sci[p.n].peek(a % 8);
    case Unit::adc:
      adc.advance(*this, time());
      return adc.peek(a);
    case Unit::wdt:
      return wdt[p.n].peek(*this, p.n, (a & 1) != 0, time());
    case Unit::flash:
      return flash_control.peek(a);
    case Unit::dtc:
      return dtc.peek(a);
    case Unit::system:
      break;
    default:
      return std::nullopt;
  }
  switch (a) {
    case io::SYSCR2:
      return system.syscr2;
    case io::SBYCR:
      return system.sbycr;
    case io::LPWRCR:
      return system.lpwrcr;
    case io::MSTPCRH:
      return static_cast<std::uint8_t>(system.mstpcr >> 8);
    case io::MSTPCRL:
      return static_cast<std::uint8_t>(system.mstpcr);
    case io::STCR:
      return system.stcr;
    case io::SYSCR:
      return system.syscr;
    case io::MDCR:
      return system.mdcr;
    case io::BCR:
      return system.bcr;
    default:
      return system.wscr;
  }
}

void Machine::write_register(const Place& p, std::uint32_t a, std::uint8_t value, States at) {
  if (module_stopped(p)) {
    misuse(a, "write to a register whose module is stopped (MSTPCR); the write has no effect");
    return;
  }
  switch (p.unit) {
    case Unit::interrupts:
      irq.write(a, value, at);
      return;
    case Unit::ports:
      ports.write(*this, a, value, at);
      return;
    case Unit::frt:
      frt.write(*this, a, value, at);
      return;
    case Unit::tmr:
      tmr.write(*this, a, value, at);
      return;
    case Unit::tmr_xy:
      tmr_xy.write(*this, a, value, at);
      return;
    case Unit::pwmx:
      pwmx.write(*this, a, value, at);
      return;
    case Unit::pwm:
    case Unit::pwm_clock:
      pwm.write(*this, a, value, at);
      return;
    case Unit::sci:
      sci[p.n].write(*this, p.n, a % 8, value, at);
      return;
    case Unit::adc:
      adc.write(*this, a, value, at);
      return;
    case Unit::wdt:
      misuse(
          a,
          "a byte write to a watchdog register has no effect; write a word with the key (5A or A5) "
          "in the upper byte");
      return;
    case Unit::flash:
      flash_control.write(*this, a, value, at);
      return;
    case Unit::dtc:
      dtc.write(*this, a, value, at);
      return;
    case Unit::system:
      write_system(a, value, at);
      return;
    case Unit::absent:
      misuse(a, "write to a register of a module that is not emulated");
      return;
    case Unit::none:
      misuse(a, "write to an address without a register");
      return;
  }
}

void Machine::io_write_word(std::uint32_t address, std::uint16_t value) {
  const Place& p = place_of(address & 0xffff, system.stcr);
  if (p.unit == Unit::wdt) {
    const States at = time();
    wdt[p.n].write_word(*this, p.n, value, at);
    accessed(p, address & 0xffff, at, true);
    return;
  }
  io_write(address, static_cast<std::uint8_t>(value >> 8));
  io_write(address + 1, static_cast<std::uint8_t>(value));
}

void Machine::write_system(std::uint32_t a, std::uint8_t value, States at) {
  switch (a) {
    case io::SYSCR2:
      system.syscr2 = value;
      break;
    case io::SBYCR:
      system.sbycr = value & ~SBYCR::ZERO;
      break;
    case io::LPWRCR:
      system.lpwrcr = value & ~LPWRCR::ZERO;
      break;
    case io::MSTPCRH:
      set_module_stop(static_cast<std::uint16_t>(value << 8 | (system.mstpcr & 0xff)), at);
      break;
    case io::MSTPCRL:
      set_module_stop(static_cast<std::uint16_t>((system.mstpcr & 0xff00) | value), at);
      break;
    case io::STCR:
      tmr.advance(*this, at);
      system.stcr = value & ~STCR::ZERO;
      find_frequent();
      tmr.clock_changed(*this, at);
      break;
    case io::SYSCR:
      system.syscr = (value & ~SYSCR::XRST) | (system.syscr & SYSCR::XRST);
      if (value & SYSCR::HIE) misuse(a, "SYSCR.HIE set: this part has no host interface");
      if (value & SYSCR::INTM1)
        misuse(a, "SYSCR.INTM1 set: interrupt control modes 2 and 3 do not exist");
      cpu.two_level = (value & SYSCR::INTM0) != 0;
      set_ram_enabled((value & SYSCR::RAME) != 0);
      break;
    case io::MDCR:
      system.mdcr = (value & MDCR::EXPE) | (system.mdcr & MDCR::MDS);
      if (value & MDCR::EXPE) misuse(a, "MDCR.EXPE set: expanded mode is not modeled");
      break;
    case io::BCR:
      system.bcr = value;
      break;
    default:
      system.wscr = value;
      break;
  }
}

// Entering module stop resets SCI, A/D and PWM; timers keep their state.
void Machine::set_module_stop(std::uint16_t value, States at) {
  run_modules(at);
  const auto entered = static_cast<std::uint16_t>(value & ~system.mstpcr);
  system.mstpcr = value;
  find_frequent();
  if (entered >> kStopSci0 & 1) sci[0].reset(*this, 0, at);
  if (entered >> kStopSci1 & 1) sci[1].reset(*this, 1, at);
  if (entered >> kStopAdc & 1) adc.reset(*this, at);
  if (entered >> kStopPwm & 1) {
    pwm.reset();
    pwmx.reset();
    notify(OutputChange::Unit::port, 1, at);
    notify(OutputChange::Unit::pwm, -1, at);
  }
}

}  // namespace kaz::h8s
