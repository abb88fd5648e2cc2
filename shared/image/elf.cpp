// ELF32, big-endian, machine 46 (H8/300 family): contents, entry and symbols.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstring>

#include "shared/image/object_file.h"

namespace kaz::h8s {
namespace {

constexpr std::size_t kHeader = 52, kProgramHeader = 32, kSectionHeader = 40, kSymbolSize = 16;
constexpr unsigned kMachine = 46, kExecutable = 2, kRelocatable = 1;
constexpr std::uint32_t kSymbolTable = 2, kNoBits = 8, kAllocated = 2, kLoad = 1;
// e_flags: the family member in bits 16 to 23.
constexpr std::uint32_t kMemberMask = 0x00ff0000, kH8300 = 0x00800000, kH8300hn = 0x00840000,
                        kH8300sn = 0x00850000;

constexpr std::uint64_t kMemory = 0x1000000;  // addresses have 24 bits

std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%x", value);
  return text;
}

class Reader final : public ObjectFile {
 public:
  using ObjectFile::ObjectFile;

  Result<Image> read() {
    if (bytes_.size() < kHeader) return error(0, "the file ends inside its header");
    if (std::memcmp(bytes_.data(),
                    "\x7f"
                    "ELF",
                    4) != 0)
      return error(0, "7f 45 4c 46 expected");
    if (bytes_[4] != 1) return error(4, "not a 32-bit file (class 1 expected)");
    if (bytes_[5] != 2) return error(5, "not big-endian (data 2 expected)");
    if (u16(18) != kMachine)
      return error(18, "machine " + std::to_string(u16(18)) + ", 46 (H8/300 family) expected");
    if (u16(16) == kRelocatable) return error(16, "an object file that has not been linked");
    if (u16(16) != kExecutable)
      return error(16, "type " + std::to_string(u16(16)) + ", 2 (executable) expected");
    image_.entry = u32(24);
    const std::uint32_t member = u32(36) & kMemberMask;
    image_.normal_mode = member == kH8300 || member == kH8300hn || member == kH8300sn;
    KAZ_TRY(read_headers());
    for (const Section& s : sections_) {
      KAZ_TRY(read_section(s));
    }
    if (image_.segments.empty()) {
      for (const Program& p : programs_) {
        KAZ_TRY(read_program(p));
      }
    }
    if (image_.segments.empty()) return error(0, "no section or segment with contents");
    image_.symbols = SymbolTable(std::move(symbols_), {});
    return std::move(image_);
  }

 private:
  struct Section {
    std::size_t at;
    std::uint32_t name, type, flags, address, offset, size, link, entry_size;
  };
  struct Program {
    std::size_t at;
    std::uint32_t type, offset, run, load, size, memory_size;
  };

  // A name of a string table; none where there is no such section.
  std::string name_in(std::uint32_t table, std::uint32_t offset) const {
    if (table >= sections_.size()) return "";
    return text(std::size_t{sections_[table].offset} + offset, kLongestName);
  }

  Result<void> read_headers() {
    const std::size_t programs = u16(44), sections = u16(48);
    if (programs != 0 && u16(42) < kProgramHeader)
      return error(42, "program headers of fewer than 32 bytes");
    if (sections != 0 && u16(46) < kSectionHeader)
      return error(46, "section headers of fewer than 40 bytes");
    if (programs != 0 && !fits(u32(28), programs * u16(42)))
      return error(28, "the program headers lie outside the file");
    if (sections != 0 && !fits(u32(32), sections * u16(46)))
      return error(32, "the section headers lie outside the file");
    for (std::size_t k = 0; k < programs; ++k) {
      const std::size_t at = u32(28) + k * u16(42);
      programs_.push_back(
          {at, u32(at), u32(at + 4), u32(at + 8), u32(at + 12), u32(at + 16), u32(at + 20)});
      KAZ_TRY(check_memory(programs_.back()));
    }
    for (std::size_t k = 0; k < sections; ++k) {
      const std::size_t at = u32(32) + k * u16(46);
      sections_.push_back({at, u32(at), u32(at + 4), u32(at + 8), u32(at + 12), u32(at + 16),
                           u32(at + 20), u32(at + 24), u32(at + 36)});
    }
    return {};
  }

  Result<void> check_memory(const Program& p) const {
    if (p.type != kLoad) return {};
    const std::string sizes =
        "the segment at address " + hex(p.run) + " has p_memsz " + hex(p.memory_size);
    if (p.size > p.memory_size)
      return error(p.at, sizes + ": must be at least its p_filesz " + hex(p.size) +
                             "; link the program again");
    if (std::uint64_t{p.run} + p.memory_size > kMemory)
      return error(p.at, sizes +
                             ": must end at or below 0xffffff, the last address of the chip; "
                             "check the linker script");
    return {};
  }

  // Where the segment that holds the section's bytes is put: .data is loaded behind .text.
  std::uint32_t load_address(const Section& s) const {
    for (const Program& p : programs_) {
      if (p.type == kLoad && s.offset >= p.offset && s.offset - p.offset < p.size &&
          s.size <= p.size - (s.offset - p.offset))
        return p.load + (s.offset - p.offset);
    }
    return s.address;
  }

  Result<void> read_section(const Section& s) {
    if (s.type == kSymbolTable) return read_symbols(s);
    if (!(s.flags & kAllocated) || s.type == kNoBits || s.size == 0) return {};
    const std::string name = name_in(u16(50), s.name);
    return add(s.at, name, {load_address(s), s.address, name, {}}, s.offset, s.size);
  }

  Result<void> read_program(const Program& p) {
    if (p.type != kLoad || p.size == 0) return {};
    return add(p.at, "segment", {p.load, p.run, "segment", {}}, p.offset, p.size);
  }

  Result<void> read_symbols(const Section& s) {
    if (s.entry_size < kSymbolSize)
      return error(s.at, "symbols of " + std::to_string(s.entry_size) + " bytes, 16 expected");
    if (!fits(s.offset, s.size)) return error(s.at, "the symbol table lies outside the file");
    for (std::size_t k = 0; k + kSymbolSize <= s.size; k += s.entry_size) {
      const std::size_t at = s.offset + k;
      const unsigned type = bytes_[at + 12] & 15u, section = u16(at + 14);
      // Data, functions and those without a type; not sections and files; not absolute numbers.
      if (type > 2 || section == 0 || section >= 0xff00) continue;
      std::string name = name_in(s.link, u32(at));
      if (name.empty() || name[0] == '.') continue;
      const bool function = type == 2;
      symbols_.push_back({std::move(name), u32(at + 4), function, function ? u32(at + 8) : 0});
    }
    return {};
  }

  std::vector<Program> programs_;
  std::vector<Section> sections_;
};

}  // namespace

Result<Image> parse_elf(std::span<const std::uint8_t> bytes, const std::string& name) {
  return Reader(bytes, name).read();
}

}  // namespace kaz::h8s
