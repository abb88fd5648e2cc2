// Chip: forwards the public interface to Machine and logs external inputs.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/chip.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/cpu/access.h"

namespace kaz::h8s {
namespace {

// Return address used by call(): a register, so that the fetch there ends the run.
constexpr std::uint32_t kReturn = 0xff0000 | io::TCONRS;

std::string hex6(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%06x", value & 0xffffff);
  return text;
}

}  // namespace

Chip::Chip(const Options& options) : machine_(std::make_unique<Machine>(options)) {}
Chip::Chip(std::unique_ptr<Machine> machine) : machine_(std::move(machine)) {}
Chip::~Chip() = default;
Chip::Chip(Chip&&) noexcept = default;
Chip& Chip::operator=(Chip&&) noexcept = default;

Chip Chip::clone() const {
  machine_->convert_all();
  return Chip(std::make_unique<Machine>(*machine_));
}

std::shared_ptr<const Chip> Chip::save() const {
  machine_->convert_all();
  return std::shared_ptr<const Chip>(new Chip(std::make_unique<Machine>(*machine_)));
}

void Chip::restore(const Chip& saved) {
  machine_->log_cut();
  machine_->take_state(*saved.machine_);
  machine_->memory_changed(0, 0);
}

void Chip::write_state(StateWriter& to) const {
  machine_->convert_all();
  machine_->write_state(to);
}

void Chip::read_state(StateReader& from) {
  machine_->log_cut();
  machine_->read_state(from);
  machine_->memory_changed(0, 0);
}

Result<void> Chip::load(const Image& image) {
  for (const Segment& s : image.segments) {
    const std::uint64_t end = std::uint64_t{s.load_address} + s.bytes.size();
    if (end > kFlashSize)
      return fail("segment '" + s.name + "' at " + hex6(s.load_address) + " with " +
                  std::to_string(s.bytes.size()) +
                  " bytes does not fit into the flash (000000 to 01ffff)");
  }
  machine_->log_cut();
  std::uint8_t* flash = machine_->memory_at(0);
  std::fill_n(flash, kFlashSize, std::uint8_t{0xff});
  for (const Segment& s : image.segments)
    std::copy(s.bytes.begin(), s.bytes.end(), flash + s.load_address);
  machine_->forget_all_code();
  machine_->memory_changed(0, kFlashSize);
  if (!image.symbols.symbols().empty()) set_symbols(image.symbols);
  return {};
}

Result<void> Chip::place(const Image& image, std::uint32_t entry) {
  for (const Segment& s : image.segments) {
    if (!poke(s.run_address, s.bytes))
      return fail("section '" + s.name + "' at " + hex6(s.run_address) + " with " +
                  std::to_string(s.bytes.size()) + " bytes does not lie in flash and RAM");
  }
  if (!image.symbols.symbols().empty()) set_symbols(image.symbols);
  Registers r = registers();
  r.pc = entry;
  set_registers(r);
  return {};
}

void Chip::set_symbols(SymbolTable symbols) {
  machine_->symbols = std::make_shared<const SymbolTable>(std::move(symbols));
}
const SymbolTable& Chip::symbols() const {
  return *machine_->symbols;
}

void Chip::power_on(std::uint8_t ram_fill) {
  machine_->log_cut();
  machine_->power_on(ram_fill);
}
void Chip::reset() {
  machine_->log_input([](Chip& c) { c.reset(); });
  machine_->reset(ResetCause::pin, machine_->cpu.now);
}
void Chip::set_mode_pins(int mode) {
  machine_->log_input([mode](Chip& c) { c.set_mode_pins(mode); });
  machine_->options.mode = mode;
}
bool Chip::in_boot_rom() const {
  return machine_->boot.active();
}
Stop Chip::run_until(States until) {
  return machine_->run(*this, until, false);
}
Stop Chip::step(States no_later) {
  return machine_->run(*this, no_later, true);
}
States Chip::now() const {
  return machine_->time();
}
std::int64_t Chip::instructions() const {
  return machine_->cpu.executed;
}
std::int64_t Chip::translated_instructions() const {
  const Translator* translator = machine_->translator();
  return translator ? translator->executed() : 0;
}
Engine Chip::engine() const {
  const Cpu& cpu = machine_->cpu;
  if (cpu.engine != Engine::translator) return cpu.engine;
  return cpu.translated && !cpu.normal ? Engine::translator : Engine::interpreter;
}
bool Chip::asleep() const {
  return machine_->cpu.asleep;
}
ResetCause Chip::reset_cause() const {
  return machine_->cause;
}
void Chip::on_watchdog_reset(std::function<void(States)> listener) {
  machine_->listeners.watchdog = std::move(listener);
}

Registers Chip::registers() const {
  const Cpu& c = machine_->cpu;
  return {c.er, machine_->pc(), ccr(c), c.exr};
}

void Chip::set_registers(const Registers& registers) {
  machine_->log_input([registers](Chip& c) { c.set_registers(registers); });
  Cpu& c = machine_->cpu;
  c.er = registers.er;
  set_ccr(c, registers.ccr);
  c.exr = registers.exr | EXR::ONE;
  if (registers.pc != machine_->pc()) {
    c.moving = false;
    c.asleep = false;
    machine_->set_pc(registers.pc);
  }
}

std::optional<std::uint8_t> Chip::peek(std::uint32_t address) const {
  if (const std::uint8_t* p = machine_->memory_at(address)) return *p;
  if (machine_->is_io(address)) return machine_->io_peek(address);
  return std::nullopt;
}

bool Chip::peek(std::uint32_t address, std::span<std::uint8_t> to) const {
  for (std::size_t k = 0; k < to.size(); ++k) {
    const auto byte = peek(address + static_cast<std::uint32_t>(k));
    if (!byte) return false;
    to[k] = *byte;
  }
  return true;
}

std::optional<std::uint16_t> Chip::peek16(std::uint32_t address) const {
  std::array<std::uint8_t, 2> b{};
  if (!peek(address, b)) return std::nullopt;
  return big16(b.data());
}

std::optional<std::uint32_t> Chip::peek32(std::uint32_t address) const {
  std::array<std::uint8_t, 4> b{};
  if (!peek(address, b)) return std::nullopt;
  return big32(b.data());
}

bool Chip::poke(std::uint32_t address, std::uint8_t value) {
  return poke(address, std::span(&value, 1));
}

bool Chip::poke(std::uint32_t address, std::span<const std::uint8_t> from) {
  machine_->log_input([address, bytes = std::vector(from.begin(), from.end())](Chip& c) {
    c.poke(address, bytes);
  });
  for (std::size_t k = 0; k < from.size(); ++k) {
    const std::uint32_t at = address + static_cast<std::uint32_t>(k);
    std::uint8_t* p = machine_->memory_at(at);
    if (!p) return false;
    *p = from[k];
    machine_->forget_code_at(at);
    machine_->memory_changed(at, 1);
  }
  return true;
}

void Chip::set_hook(std::uint32_t address, CodeHook hook) {
  machine_->set_hook(address, std::move(hook));
}
void Chip::set_breakpoint(std::uint32_t address) {
  set_hook(address, [](Chip&) { return HookAction::stop; });
}
void Chip::clear_hook(std::uint32_t address) {
  machine_->clear_hook(address);
}

void Chip::attach(Observer& observer) {
  machine_->attach(observer);
}
void Chip::detach(Observer& observer) {
  machine_->detach(observer);
}
void Chip::set_input_log(InputLog* log) {
  machine_->convert_all();
  machine_->input_log = log;
  machine_->connect_analog();
  machine_->reschedule_all();
}
void Chip::request_stop() {
  machine_->request_stop();
}

Result<CallResult> Chip::call(std::uint32_t address, std::initializer_list<std::uint32_t> args,
                              States limit) {
  machine_->log_cut();
  if (args.size() > 3) return fail("call takes at most three arguments, in ER0, ER1 and ER2");
  Registers r = registers();
  std::copy(args.begin(), args.end(), r.er.begin());
  const std::uint32_t width = machine_->cpu.normal ? 2 : 4;
  r.er[7] -= width;
  for (std::uint32_t k = 0; k < width; ++k) {
    if (!poke(r.er[7] + k, static_cast<std::uint8_t>(kReturn >> (8 * (width - 1 - k)))))
      return fail("call of " + symbols().describe(address) + ": the stack pointer " +
                  hex6(r.er[7]) + " is not in RAM");
  }
  r.ccr |= CCR::I | CCR::UI;
  r.pc = address;
  set_registers(r);
  const States start = now();
  const Stop stop = run_until(start + limit);
  const std::uint32_t pc = machine_->pc(), back = kReturn & machine_->cpu.mask;
  if (stop.reason == Stop::Reason::undefined_instruction && pc == back) {
    machine_->revive();
    return CallResult{machine_->cpu.er[0], now() - start};
  }
  const std::string name = "call of " + symbols().describe(address);
  if (stop.reason == Stop::Reason::reached)
    return fail(name + " has not returned after " + std::to_string(limit) + " states");
  return fail(name + " stopped: " + stop.report.substr(0, stop.report.find('\n')));
}

std::string Chip::disassemble(std::uint32_t address, int* length) const {
  return machine_->disassemble(address, length);
}
std::string Chip::report() const {
  return machine_->report("running");
}
const FlashStatistics& Chip::flash_statistics() const {
  return machine_->flash_control.statistics;
}
const std::vector<Misuse>& Chip::misuse() const {
  return machine_->misuses;
}

PortOutput Chip::output(Port port) const {
  if (port == Port::p6) machine_->advance_outputs(machine_->event_time());
  return machine_->ports.output(*machine_, static_cast<unsigned>(port), machine_->event_time());
}

void Chip::set_input(Port port, int bit, bool level) {
  if (bit < 0 || bit > 7) return;
  machine_->log_input([=](Chip& c) { c.set_input(port, bit, level); });
  machine_->set_input(static_cast<unsigned>(port), static_cast<unsigned>(bit), level);
}

void Chip::release_input(Port port, int bit) {
  if (bit < 0 || bit > 7) return;
  machine_->log_input([=](Chip& c) { c.release_input(port, bit); });
  machine_->set_input(static_cast<unsigned>(port), static_cast<unsigned>(bit), std::nullopt);
}

void Chip::set_nmi(bool level) {
  machine_->log_input([level](Chip& c) { c.set_nmi(level); });
  machine_->set_nmi(level);
}

void Chip::on_output(std::function<void(const OutputChange&)> listener) {
  machine_->listeners.output = std::move(listener);
}

int Chip::pw_high_counts(int channel) const {
  return machine_->pw_high_counts(channel);
}
bool Chip::pw_driven(int channel) const {
  return machine_->pw_driven(channel);
}
double Chip::tmo_high_share(int timer) const {
  return machine_->tmo_high_share(timer);
}
bool Chip::tmo_driven(int timer) const {
  return machine_->tmo_driven(timer);
}

void Chip::set_analog(std::function<double(int channel, States at)> source, bool steady) {
  machine_->convert_all();
  machine_->analog_source = std::move(source);
  machine_->steady_analog = steady;
  machine_->connect_analog();
  machine_->reschedule_all();
}

Result<void> Chip::receive(int sci, const ReceivedByte& byte) {
  if (sci < 0 || sci > 1)
    return fail("receive on SCI" + std::to_string(sci) + ": the chip has SCI0 and SCI1");
  auto& queue = machine_->sci[static_cast<std::size_t>(sci)].incoming();
  const States earliest = queue.empty() ? now() : queue.back().at;
  if (byte.at < earliest)
    return fail("byte received at state " + std::to_string(byte.at) + " lies before state " +
                std::to_string(earliest) +
                " (the present state, or the state of the last queued byte)");
  if (machine_->input_log) machine_->log_input([=](Chip& c) { (void)c.receive(sci, byte); });
  queue.push_back(byte);
  machine_->rescheduled(sci == 0 ? Source::sci0 : Source::sci1);
  return {};
}

void Chip::on_transmit(std::function<void(int sci, const TransmittedByte&)> listener) {
  machine_->listeners.transmitted = std::move(listener);
}

// Pins.

PinState Chip::state(Pin pin) const {
  const States at = machine_->event_time();
  machine_->advance_outputs(at);
  return pin_state(*machine_, pin, at);
}

int Chip::watch(Pin pin, PinListener listener, bool drivers) {
  const States at = machine_->event_time();
  machine_->advance_outputs(at);
  const int id = machine_->pins.watch(*machine_, pin, std::move(listener), drivers, at);
  machine_->reschedule_all();
  return id;
}

void Chip::unwatch(int watch) {
  machine_->pins.unwatch(watch);
}

int Chip::call_at(States at, std::function<void(States)> call) {
  const int id = machine_->pins.call_at(std::max(at, machine_->event_time()), std::move(call));
  machine_->reschedule_all();
  return id;
}

void Chip::cancel(int call) {
  machine_->pins.cancel(call);
  machine_->reschedule_all();
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
