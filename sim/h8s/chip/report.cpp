// The report of a stop: registers, back-trace from a stack scan, the last instructions.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <vector>

#include "sim/h8s/chip/machine.h"
#include "sim/h8s/cpu/access.h"
#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {
namespace {

constexpr std::size_t kLast = 32;

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[160];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

std::string registers_text(const Cpu& c) {
  std::string text;
  for (unsigned n = 0; n < 8; ++n)
    text += format("  ER%u %08x%s", n, c.er[n], n == 3 ? "\n" : n == 7 ? " (SP)\n" : "");
  const unsigned flags = ccr(c);
  text += format("  PC %06x  CCR %02x [", pc_of(c, c.ip), flags);
  const char* names = "I UI H U N Z V C";
  bool first = true;
  for (int bit = 7; *names; --bit) {
    std::string name;
    while (*names && *names != ' ') name += *names++;
    if (*names) ++names;
    if (!(flags >> bit & 1)) continue;
    text += (first ? "" : " ") + name;
    first = false;
  }
  return text + "]\n";
}

// The last instructions executed, oldest first: those between two recorded jumps are sequential.
std::vector<std::uint32_t> last_run(const Machine& m) {
  const Cpu& c = m.cpu;
  std::vector<std::uint32_t> result;
  const std::uint32_t known = std::min(c.jumps, kTrail);
  for (std::uint32_t k = 0; k <= known; ++k) {
    if (k == 0 && known == kTrail) continue;  // its beginning is lost
    const Insn* start = k == 0 ? nullptr : c.trail[(c.jumps - known + k - 1) % kTrail].to;
    const Insn* end = k == known ? c.ip : c.trail[(c.jumps - known + k) % kTrail].from;
    if (!end || end == &c.outside) continue;
    if (!start || start == &c.outside) start = end;
    std::uint32_t pc = pc_of(c, start);
    const std::uint32_t last = pc_of(c, end);
    for (int n = 0; n < 100'000 && pc <= last; ++n) {
      if (k == known && pc == last) break;  // not run yet
      result.push_back(pc);
      int length = 2;
      m.disassemble(pc, &length);
      pc += static_cast<std::uint32_t>(length);
    }
  }
  if (result.size() > kLast)
    result.erase(result.begin(), result.end() - static_cast<std::ptrdiff_t>(kLast));
  return result;
}

// A stacked long word counts as a return address if a call instruction precedes its target.
bool follows_call(const Machine& m, std::uint32_t address) {
  if ((address & 1) || address < 4) return false;
  const auto starts = [&](std::uint32_t back, unsigned first, unsigned mask) {
    const std::uint8_t* p = m.memory_at(address - back);
    return p && (p[0] & mask) == first;
  };
  return starts(2, 0x55, 0xff) || starts(2, 0x5d, 0xfd) || starts(4, 0x5c, 0xff) ||
         starts(4, 0x5e, 0xff);
}

std::string back_trace(const Machine& m) {
  std::string text;
  const std::uint32_t sp = m.cpu.er[7] & m.cpu.mask & ~1u;
  const std::uint32_t step = m.cpu.normal ? 2 : 4;
  int shown = 0;
  for (std::uint32_t a = sp; shown < 24; a += 2) {
    const std::uint8_t* p = m.memory_at(a);
    const std::uint8_t* end = m.memory_at(a + step - 1);
    if (!p || !end || a < m.cpu.flash_size) break;
    const std::uint32_t value = m.cpu.normal ? big16(p) : big32(p);
    if (value > 0xffffff || !follows_call(m, value)) continue;
    text += format("  %06x  ", value) + m.symbols->describe(value) + "\n";
    ++shown;
    a += step - 2;
  }
  return text.empty() ? "  (no return address found)\n" : text;
}

}  // namespace

std::string Machine::disassemble(std::uint32_t address, int* length) const {
  std::array<std::uint16_t, kMaxUnits> units{};
  std::size_t available = 0;
  for (; available < kMaxUnits; ++available) {
    const std::uint8_t* p = memory_at(address + 2 * static_cast<std::uint32_t>(available));
    const std::uint8_t* q = memory_at(address + 2 * static_cast<std::uint32_t>(available) + 1);
    if (!p || !q) break;
    units[available] = static_cast<std::uint16_t>(*p << 8 | *q);
  }
  return h8s::disassemble(std::span(units).first(available), address, length);
}

std::string Machine::report(const std::string& headline) const {
  std::string text = headline + "\n";
  text += format("state %lld after %lld instructions\n", static_cast<long long>(cpu.now),
                 static_cast<long long>(cpu.executed));
  text += registers_text(cpu);
  text += "in " + symbols->describe(pc()) + ": " + disassemble(pc(), nullptr) + "\n";
  text += "called from\n" + back_trace(*this);
  text +=
      translator() && translator()->translated() > 0
          ? "last instructions that were not translated (to list all instructions, use the engine "
            "`interpreter`)\n"
          : "last instructions\n";
  for (const std::uint32_t at : last_run(*this))
    text +=
        format("  %06x  ", at) + disassemble(at, nullptr) + "  ; " + symbols->describe(at) + "\n";
  if (!misuses.empty()) {
    text += "register misuse\n";
    for (const Misuse& m : misuses)
      text += format("  %06x from %06x, %lld times: ", m.address, m.pc,
                     static_cast<long long>(m.count)) +
              m.text + "\n";
  }
  return text;
}

}  // namespace kaz::h8s
