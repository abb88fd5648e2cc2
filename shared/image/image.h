// A program as a toolchain leaves it: bytes at addresses, entry, symbols, line numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::h8s {

struct Segment {
  std::uint32_t load_address = 0;  // where the programmer puts it (flash)
  std::uint32_t run_address = 0;   // where the program expects it; differs for .data
  std::string name;
  std::vector<std::uint8_t> bytes;
};

struct Symbol {
  std::string name;  // as in the object file: C's `main` is `_main`
  std::uint32_t address = 0;
  bool function = false;
  std::uint32_t size = 0;  // bytes of a function; 0: the file does not state it
};

struct SourceLine {
  std::uint32_t address = 0;
  std::string file;
  std::uint32_t line = 0;
};

class SymbolTable {
 public:
  SymbolTable() = default;
  SymbolTable(std::vector<Symbol> symbols, std::vector<SourceLine> lines);

  // With or without C's leading underscore.
  std::optional<std::uint32_t> address_of(std::string_view name) const;
  // The symbol that covers `address`: the nearest at or below it, compiler-made labels left out.
  const Symbol* at(std::uint32_t address) const;
  const SourceLine* line_at(std::uint32_t address) const;
  // "_main+0x12 (main.c:34)", "_main" or "0x001234".
  std::string describe(std::uint32_t address) const;

  const std::vector<Symbol>& symbols() const { return symbols_; }
  const std::vector<SourceLine>& lines() const { return lines_; }

 private:
  std::vector<Symbol> symbols_;    // by address
  std::vector<SourceLine> lines_;  // by address
  std::vector<std::size_t> by_name_;
};

struct Image {
  std::vector<Segment> segments;
  std::optional<std::uint32_t> entry;
  bool normal_mode = false;  // built for 16-bit addresses
  SymbolTable symbols;
};

// `name` is used in messages. Motorola S-records: S0, S1/S2/S3, S5, S7/S8/S9.
Result<Image> parse_srecord(std::string_view text, const std::string& name);
// Intel HEX: records 00 to 05.
Result<Image> parse_intel_hex(std::string_view text, const std::string& name);
// COFF of h8300-hms (magic 0x8302 H8S, 0x8301 H8/300H; 0x8300, 0x8303 and 0x8304 with 16-bit
// addresses), symbols and line numbers.
Result<Image> parse_coff(std::span<const std::uint8_t> bytes, const std::string& name);
// ELF32, big-endian, machine 46, linked: sections with contents (segments where there are none) and
// symbols.
Result<Image> parse_elf(std::span<const std::uint8_t> bytes, const std::string& name);

enum class Format { automatic, coff, elf, srecord, intel_hex, raw };

struct LoadOptions {
  Format format = Format::automatic;     // recognised by the first bytes; never raw
  std::optional<std::uint32_t> address;  // of a raw image's first byte, its entry too
};
Result<Image> load_image(const std::string& path, const LoadOptions& options = {});

}  // namespace kaz::h8s
