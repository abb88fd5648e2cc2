// Program images as written by a toolchain (segments, entry, symbols, lines), and parsers of image files.
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
  std::uint32_t load_address = 0;  // address in flash
  std::uint32_t run_address = 0;   // address at run time; differs from load_address for .data
  std::string name;
  std::vector<std::uint8_t> bytes;
};

struct Symbol {
  std::string name;  // name in the object file: `_main` for C's main
  std::uint32_t address = 0;
  bool function = false;
  std::uint32_t size = 0;  // bytes of a function; 0: unknown
};

// First address of the code of a source line.
struct SourceLine {
  std::uint32_t address = 0;
  std::string file;
  std::uint32_t line = 0;
};

// Finds symbols by name and address, and source lines by address. Returned pointers are valid as long as the
// table exists.
class SymbolTable {
 public:
  SymbolTable() = default;
  SymbolTable(std::vector<Symbol> symbols, std::vector<SourceLine> lines);

  // Returns the address of a symbol. The leading underscore of C can be omitted from `name`.
  std::optional<std::uint32_t> address_of(std::string_view name) const;
  // Returns the nearest symbol at or below `address`, or null. The parsers omit compiler-generated labels.
  const Symbol* at(std::uint32_t address) const;
  // Returns the nearest source line at or below `address`, or null.
  const SourceLine* line_at(std::uint32_t address) const;
  // Returns text such as "_main+0x12 (main.c:34)" or "_main". If no symbol is at `address` or up
  // to 0x8000 bytes below `address`, returns only the address, such as "0x001234".
  std::string describe(std::uint32_t address) const;

  const std::vector<Symbol>& symbols() const { return symbols_; }
  const std::vector<SourceLine>& lines() const { return lines_; }

 private:
  std::vector<Symbol> symbols_;       // sorted by address
  std::vector<SourceLine> lines_;     // sorted by address
  std::vector<std::size_t> by_name_;  // indices into symbols_, sorted by name
};

struct Image {
  std::vector<Segment> segments;
  std::optional<std::uint32_t> entry;
  bool normal_mode = false;  // true: built for 16-bit addresses
  SymbolTable symbols;
};

// Errors of the parsers contain `name` and the place of the fault in the file.
//
// Parses Motorola S-records: S0, S1/S2/S3, S5/S6, S7/S8/S9.
Result<Image> parse_srecord(std::string_view text, const std::string& name);
// Parses Intel HEX: records 00 to 05.
Result<Image> parse_intel_hex(std::string_view text, const std::string& name);
// Parses COFF of h8300-hms with symbols and line numbers. Magic: 0x8302 for H8S, 0x8301 for H8/300H; 0x8300,
// 0x8303 and 0x8304 for 16-bit addresses.
Result<Image> parse_coff(std::span<const std::uint8_t> bytes, const std::string& name);
// Parses linked ELF32, big-endian, machine 46, with symbols. Reads the contents of the sections. If no
// section has contents, reads the segments instead. Refuses a segment that is larger in the file than in
// memory, or that ends beyond address 0xffffff.
Result<Image> parse_elf(std::span<const std::uint8_t> bytes, const std::string& name);

enum class Format { automatic, coff, elf, srecord, intel_hex, raw };

struct LoadOptions {
  // If `format` is Format::automatic, the format is detected from the first bytes of the file. Format::raw is
  // never detected.
  Format format = Format::automatic;
  // Address of the first byte of a raw image. The first byte is also the start of the program. For other
  // formats, `address` must be nullopt.
  std::optional<std::uint32_t> address;
};
// Reads an image file of up to 128 MB. Returns an error if the file is unreadable or invalid.
Result<Image> load_image(const std::string& path, const LoadOptions& options = {});

}  // namespace kaz::h8s
