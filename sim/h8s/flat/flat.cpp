// Flat: memory, the loop around the CPU, and semihosting requests.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/flat/flat.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <utility>

#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/opcode.h"
#include "sim/h8s/translate/translator.h"

namespace kaz::h8s {
namespace {

constexpr std::uint32_t kSize = 0x1000000, kMask = kSize - 1;
constexpr unsigned kWriteRequest = 0xc7;

struct Free {
  void operator()(void* p) const { std::free(p); }
};
template <class T>
using Zeroed = std::unique_ptr<T[], Free>;

// Fresh pages from the operating system cost nothing until touched.
template <class T>
Zeroed<T> zeroed(std::size_t count) {
  void* p = std::calloc(count, sizeof(T));
  if (!p) throw std::bad_alloc();
  return Zeroed<T>(static_cast<T*>(p));
}

std::string hex(std::uint32_t value, int digits) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%0*x", digits, value);
  return text;
}

}  // namespace

class Flat::Body {
 public:
  explicit Body(const FlatOptions& chosen)
      : ram(zeroed<std::uint8_t>(kSize)),
        lines(zeroed<std::uint8_t>(kSize / kLine + 1)),
        code(zeroed<Insn>(kSize / 2 + kGap)) {
    cpu.ram = cpu.flash = ram.get();
    cpu.has_code = lines.get();
    cpu.code = code.get();
    cpu.flash_size = cpu.quick_flash = 0;
    cpu.ram_base = cpu.ram_at = 0;
    cpu.ram_size = kSize;
    cpu.ram_code = 0;
    cpu.short_ram_code = cpu.code_size = kSize / 2 + kGap;
    cpu.flat = true;
    cpu.semihost = chosen.semihost;
    cpu.engine = chosen.engine;
    cpu.translate_after = chosen.translate_after;
    cpu.predecrement_stores_decremented = chosen.predecrement_stores_decremented;
    if (chosen.engine == Engine::translator) translator = make_translator();
    cpu.translated = translator.get();
    set_ccr(cpu, 0x80);
    cpu.ip = at_address(cpu, 0);
  }

  std::uint32_t pc() const { return pc_of(cpu, cpu.ip) & kMask; }

  void set_byte(std::uint32_t address, std::uint8_t value) {
    address &= kMask;
    ram[address] = value;
    note_ram_write(cpu, address);
  }

  // Fills in the location and the one-line text.
  FlatStop stop_at(FlatStop::Reason reason, std::uint32_t at, const std::string& what) const {
    FlatStop stop;
    stop.reason = reason;
    stop.pc = at;
    stop.opcode = big16(&ram[at & kMask & ~1u]);
    stop.text = what + ": PC " + hex(at, 6) + ", opcode " + hex(stop.opcode, 4);
    if (!symbols.symbols().empty()) stop.text += ", " + symbols.describe(at);
    return stop;
  }

  FlatStop end(FlatStop::Reason reason, std::uint32_t at, const std::string& what) {
    ended = stop_at(reason, at, what);
    return *ended;
  }

  FlatStop run(States until, std::int64_t count) {
    for (;;) {
      if (ended) return *ended;
      if (cpu.now >= until || cpu.executed >= count)
        return stop_at(FlatStop::Reason::reached, pc(), "limit reached");
      // Every instruction takes at least one state, so this many states cannot be too many.
      const std::int64_t left = std::min(until - cpu.now, count - cpu.executed);
      cpu.stop = left < kNever - cpu.now ? cpu.now + left : kNever;
      run_stretch(cpu);
      cpu.now += cpu.stall;
      cpu.stall = 0;
      if (cpu.fault != Fault::none) return fault();
      if (cpu.asleep) return sleep();
      if (cpu.request != 0) answer(std::exchange(cpu.request, std::uint8_t{0}));
    }
  }

  FlatStop fault() {
    --cpu.executed;  // it has not run
    cpu.ip = at_address(cpu, cpu.fault_pc);
    if (cpu.fault == Fault::odd_pc)
      return end(FlatStop::Reason::odd_pc, cpu.fault_pc, "instruction at an odd address");
    return end(FlatStop::Reason::undefined_instruction, cpu.fault_pc & kMask,
               "undefined instruction");
  }

  FlatStop sleep() {
    const std::uint32_t at = (pc() - 2) & kMask;
    const auto low16 = [this](std::size_t n) { return cpu.er[n] & 0xffff; };
    if (cpu.semihost && low16(1) == 0xdead && low16(2) == 0xbeef && (cpu.er[0] & 0xff) == 0) {
      ended = FlatStop{FlatStop::Reason::exited, static_cast<int>(low16(0) >> 8), at, 0x0180, ""};
      return *ended;
    }
    return end(FlatStop::Reason::asleep, at, "SLEEP without a wake-up source");
  }

  void answer(unsigned request) {
    const std::uint32_t at = (pc() - 2) & kMask;
    if (request != kWriteRequest) {
      end(FlatStop::Reason::bad_request, at,
          "host request " + hex(request, 2) + ": must be 0xc7 (write)");
      return;
    }
    if (cpu.er[0] > 2) {
      end(FlatStop::Reason::bad_request, at,
          "write to descriptor " + std::to_string(cpu.er[0]) + ": must be 0, 1 or 2");
      return;
    }
    const int stream = cpu.er[0] == 2 ? 2 : 1;
    const std::uint32_t length = cpu.er[2];
    std::uint32_t from = cpu.er[1] & kMask;
    for (std::uint32_t left = length; left != 0;) {
      const std::uint32_t piece = std::min(left, kSize - from);
      if (output && !output(stream, {&ram[from], piece})) {
        end(FlatStop::Reason::output_failed, at, "the program's output cannot be written");
        return;
      }
      left -= piece;
      from = 0;
    }
    cpu.er[0] = length;
  }

  Zeroed<std::uint8_t> ram, lines;
  Zeroed<Insn> code;
  std::unique_ptr<Translator> translator;
  Cpu cpu;
  SymbolTable symbols;
  Output output;
  std::optional<FlatStop> ended;
};

Flat::Flat(const FlatOptions& options) : body_(std::make_unique<Body>(options)) {}
Flat::~Flat() = default;
Flat::Flat(Flat&&) noexcept = default;
Flat& Flat::operator=(Flat&&) noexcept = default;

Result<void> Flat::load(const Image& image) {
  for (const Segment& s : image.segments) {
    if (s.run_address > kSize || s.bytes.size() > kSize - s.run_address)
      return fail("section '" + s.name + "' at " + hex(s.run_address, 6) + " with " +
                  std::to_string(s.bytes.size()) +
                  " bytes does not fit into the memory (000000 to ffffff)");
  }
  if (!image.entry) return fail("the image has no entry address; give one with --entry");
  if (image.normal_mode)
    return fail(
        "the image is built for 16-bit addresses; this machine has 24-bit addresses: build the "
        "image with -ms (without -mn)");
  for (const Segment& s : image.segments) poke(s.run_address, s.bytes);
  body_->symbols = image.symbols;
  Registers r = registers();
  r.pc = *image.entry;
  set_registers(r);
  return {};
}

const SymbolTable& Flat::symbols() const {
  return body_->symbols;
}
void Flat::on_output(Output listener) {
  body_->output = std::move(listener);
}
FlatStop Flat::run(States until, std::int64_t count) {
  return body_->run(until, count);
}
States Flat::now() const {
  return body_->cpu.now;
}
std::int64_t Flat::instructions() const {
  return body_->cpu.executed;
}

Registers Flat::registers() const {
  const Cpu& c = body_->cpu;
  return {c.er, body_->pc(), ccr(c), c.exr};
}

void Flat::set_registers(const Registers& registers) {
  Cpu& c = body_->cpu;
  c.er = registers.er;
  set_ccr(c, registers.ccr);
  c.exr = registers.exr | 0x78;
  if (registers.pc != body_->pc()) {
    c.moving = false;
    c.ip = at_address(c, registers.pc);
  }
  c.asleep = false;
  c.fault = Fault::none;
  body_->ended.reset();
}

std::uint8_t Flat::peek(std::uint32_t address) const {
  return body_->ram[address & kMask];
}
std::uint16_t Flat::peek16(std::uint32_t address) const {
  return static_cast<std::uint16_t>(peek(address) << 8 | peek(address + 1));
}
std::uint32_t Flat::peek32(std::uint32_t address) const {
  return static_cast<std::uint32_t>(peek16(address)) << 16 | peek16(address + 2);
}
void Flat::poke(std::uint32_t address, std::uint8_t value) {
  body_->set_byte(address, value);
}
void Flat::poke(std::uint32_t address, std::span<const std::uint8_t> from) {
  for (const std::uint8_t byte : from) body_->set_byte(address++, byte);
}

std::string Flat::disassemble(std::uint32_t address, int* length) const {
  std::array<std::uint16_t, kMaxUnits> units{};
  for (std::uint32_t k = 0; k < kMaxUnits; ++k) units[k] = peek16(address + 2 * k);
  return h8s::disassemble(units, address & kMask, length);
}

}  // namespace kaz::h8s
