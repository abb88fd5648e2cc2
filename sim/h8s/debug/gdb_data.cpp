// GDB's remote protocol: registers, memory, flash.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "sim/h8s/debug/gdb_server.h"

namespace kaz::h8s {
namespace {

constexpr unsigned kCcr = 8, kPc = 9, kCycles = 10, kExr = 11, kTick = 12, kInst = 13, kCount = 16;
constexpr std::uint32_t kFlash = 0x20000;

std::uint32_t big(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t b : bytes) value = value << 8 | b;
  return value;
}

void put(Registers& r, unsigned n, std::uint32_t value) {
  if (n < 8) r.er[n] = value;
  if (n == kCcr) r.ccr = static_cast<std::uint8_t>(value);
  if (n == kPc) r.pc = value & 0xffffff;
  if (n == kExr) r.exr = static_cast<std::uint8_t>(value);
}

std::string text_of(const Chip& chip, const Registers& r, unsigned n) {
  const auto states = static_cast<std::uint64_t>(chip.now());
  if (n < 8) return hex32(r.er[n]);
  if (n == kCcr) return hex32(r.ccr);
  if (n == kPc) return hex32(r.pc);
  if (n == kExr) return hex32(r.exr);
  if (n == kCycles) return hex32(static_cast<std::uint32_t>(states));
  if (n == kTick) return hex32(static_cast<std::uint32_t>(states >> 32));
  if (n == kInst) return hex32(static_cast<std::uint32_t>(chip.instructions()));
  return "00000000";
}

struct Range {
  std::uint32_t address;
  std::size_t size;
};

// "address,size" or, with `colon`, "address,size:" with the data left in the reader.
std::optional<Range> range(GdbReader& in, bool colon) {
  const auto address = in.number();
  if (!address || !in.take(",")) return std::nullopt;
  const auto size = in.number();
  if (!size || (colon ? !in.take(":") : !in.empty())) return std::nullopt;
  if (*address > 0xffffff || *size > 0x1000000 - *address) return std::nullopt;
  return Range{static_cast<std::uint32_t>(*address), static_cast<std::size_t>(*size)};
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

std::string GdbServer::registers() const {
  const Registers r = chip_.registers();
  std::string text;
  for (unsigned n = 0; n < kCount; ++n) text += text_of(chip_, r, n);
  return text;
}

std::string GdbServer::set_registers(Text digits) {
  Registers r = chip_.registers();
  for (unsigned n = 0; n < kCount && digits.size() >= 8; ++n, digits.remove_prefix(8)) {
    const Text one = digits.substr(0, 8);
    if (one.find_first_not_of("xX") == Text::npos) continue;  // not known, leave as it is
    const auto bytes = from_hex(one);
    if (!bytes) return "E01";
    put(r, n, big(*bytes));
  }
  if (!digits.empty()) return "E01";
  chip_.set_registers(r);
  return "OK";
}

std::string GdbServer::one_register(Text packet) const {
  GdbReader in(packet);
  const auto n = in.number();
  if (!n || !in.empty() || *n >= kCount) return "E01";
  return text_of(chip_, chip_.registers(), static_cast<unsigned>(*n));
}

std::string GdbServer::set_one_register(Text packet) {
  GdbReader in(packet);
  const auto n = in.number();
  if (!n || *n >= kCount || !in.take("=")) return "E01";
  const auto bytes = from_hex(in.rest());
  if (!bytes || bytes->empty() || bytes->size() > 4) return "E01";
  Registers r = chip_.registers();
  put(r, static_cast<unsigned>(*n), big(*bytes));
  chip_.set_registers(r);
  return "OK";
}

// Reads as far as there is memory.
std::string GdbServer::read_memory(Text packet) const {
  GdbReader in(packet);
  const auto r = range(in, false);
  if (!r) return "E01";
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t at = r->address; bytes.size() < std::min(r->size, kMaxPacket / 2 - 8); ++at) {
    const auto byte = chip_.peek(at);
    if (!byte) break;
    bytes.push_back(*byte);
  }
  if (bytes.empty() && r->size != 0) return "E14";
  return to_hex(bytes);
}

std::string GdbServer::write_memory(Text packet, bool binary) {
  GdbReader in(packet);
  const auto r = range(in, true);
  if (!r) return "E01";
  std::vector<std::uint8_t> bytes(bytes_of(in.rest()).begin(), bytes_of(in.rest()).end());
  if (!binary) {
    auto decoded = from_hex(in.rest());
    if (!decoded) return "E01";
    bytes = std::move(*decoded);
  }
  if (bytes.size() != r->size) return "E01";
  if (bytes.empty()) return "OK";
  return chip_.poke(r->address, bytes) ? "OK" : "E14";
}

std::string GdbServer::flash(Text packet) {
  GdbReader in(packet);
  if (in.take("vFlashErase:")) {
    const auto r = range(in, false);
    if (!r) return "E01";
    if (r->address + r->size > kFlash) return "E14";
    const std::vector<std::uint8_t> blank(r->size, 0xff);
    return blank.empty() || chip_.poke(r->address, blank) ? "OK" : "E14";
  }
  if (in.take("vFlashWrite:")) {
    const auto address = in.number();
    if (!address || !in.take(":")) return "E01";
    const auto bytes = bytes_of(in.rest());
    if (*address > kFlash || bytes.size() > kFlash - *address) return "E.memtype";
    const bool ok = bytes.empty() || chip_.poke(static_cast<std::uint32_t>(*address), bytes);
    return ok ? "OK" : "E14";
  }
  return packet == "vFlashDone" ? "OK" : "";
}

std::string GdbServer::memory_map() const {
  // In normal mode the address space ends at 0xffff and the flash before the RAM.
  const bool normal = !chip_.peek(0xe000).has_value();
  const std::uint32_t top = normal ? 0 : 0xff0000;
  const auto region = [](const char* type, std::uint32_t start, std::uint32_t length) {
    return "<memory type=\"" + std::string(type) + "\" start=\"0x" + hex32(start) +
           "\" length=\"0x" + hex32(length) + "\"";
  };
  std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE memory-map PUBLIC \"+//IDN gnu.org//DTD GDB Memory Map "
      "V1.0//EN\" \"http://sourceware.org/gdb/gdb-memory-map.dtd\">\n<memory-map>\n";
  text += region("flash", 0, normal ? 0xe000 : kFlash) +
          "><property name=\"blocksize\">0x400</property></memory>\n";
  // RAM, and the registers as RAM so that GDB reads them.
  text += region("ram", top | 0xe080, 0xf80) + "/>\n";
  text += region("ram", top | 0xfe50, 0x1b0) + "/>\n";
  return text + "</memory-map>\n";
}

}  // namespace kaz::h8s
