// Disassembly of one instruction, from the rows that decode it.
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>

#include "sim/h8s/cpu/opcode.h"

namespace kaz::h8s {
namespace {

struct Field {
  std::uint32_t value = 0;
  int bits = 0;
};

std::string format(const char* pattern, std::uint32_t value) {
  char text[32];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string byte_name(unsigned n) {
  return format(n < 8 ? "r%uh" : "r%ul", n & 7);
}
std::string word_name(unsigned n) {
  return format(n < 8 ? "r%u" : "e%u", n & 7);
}
std::string long_name(unsigned n) {
  return format("er%u", n & 7);
}

std::int32_t signed_value(const Field& f) {
  if (f.bits >= 32) return static_cast<std::int32_t>(f.value);
  const std::uint32_t sign = 1u << (f.bits - 1);
  return static_cast<std::int32_t>((f.value ^ sign) - sign);
}

std::string displacement(const Field& f) {
  const std::int32_t v = signed_value(f);
  const auto magnitude = static_cast<std::uint32_t>(v < 0 ? -static_cast<std::int64_t>(v) : v);
  return format(v < 0 ? "-0x%x" : "0x%x", magnitude) +
         format(":%u", static_cast<std::uint32_t>(f.bits));
}

std::string absolute(const Field& f) {
  std::uint32_t a = f.value;
  if (f.bits == 8) a |= 0xffff00;
  if (f.bits == 16 && (a & 0x8000)) a |= 0xff0000;
  return format("0x%06x", a) + format(":%u", static_cast<std::uint32_t>(f.bits));
}

std::string operand(char letter, const Field& f, std::uint32_t next) {
  switch (letter) {
    case 'r':
    case 's':
      return byte_name(f.value);
    case 'u':
    case 'w':
      return word_name(f.value);
    case 't':
    case 'T':
      return std::to_string(f.value & 7);
    case 'p':
      return std::to_string(f.value);
    case 'i':
      return format("0x%x", f.value);
    case 'd':
      return displacement(f);
    case 'a':
      return absolute(f);
    case 'v':
      return format("0x%02x:8", f.value);
    case 'j':
      return format("0x%06x", (next + static_cast<std::uint32_t>(signed_value(f))) & 0xffffff);
    default:
      return long_name(f.value);
  }
}

}  // namespace

std::string disassemble(std::span<const std::uint16_t> units, std::uint32_t address, int* bytes) {
  const Decoded decoded = decode(units, false);
  if (bytes) *bytes = decoded.opcode ? 2 * decoded.insn.units : 2;
  if (!decoded.opcode) return units.empty() ? "(no memory)" : format(".word 0x%04x", units[0]);
  std::array<Field, 128> fields{};
  std::size_t k = 0;
  for (const char* p = decoded.opcode->pattern; *p; ++p) {
    if (*p == ' ') continue;
    Field& f = fields[static_cast<std::size_t>(*p) & 127];
    f.value = f.value << 4 | (units[k / 4] >> (12 - 4 * (k % 4)) & 15u);
    f.bits += 4;
    ++k;
  }
  std::string text = decoded.opcode->name;
  const char* p = decoded.opcode->operands;
  if (*p) text += ' ';
  const std::uint32_t next = address + 2u * decoded.insn.units;
  for (; *p; ++p) {
    if (*p != '%')
      text += *p;
    else {
      ++p;
      text += operand(*p, fields[static_cast<std::size_t>(*p) & 127], next);
    }
  }
  return text;
}

}  // namespace kaz::h8s
