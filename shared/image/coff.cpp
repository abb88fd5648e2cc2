// COFF as h8300-hms writes it: sections, symbols, line numbers. All fields are big-endian.
// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "shared/image/object_file.h"

namespace kaz::h8s {
namespace {

constexpr std::size_t kFileHeader = 20, kSectionHeader = 40, kSymbol = 18, kLine = 8, kEntryAt = 16;
// Dummy, not loaded, copy, BSS and information sections: no contents for the memory.
constexpr std::uint32_t kNotInMemory = 0x01 | 0x02 | 0x10 | 0x80 | 0x200;
// Storage classes and the type bits of a function.
constexpr unsigned kExternal = 2, kStatic = 3, kFunctionMark = 101, kFileName = 103,
                   kFunctionType = 0x20;

class Reader final : public ObjectFile {
 public:
  using ObjectFile::ObjectFile;

  Result<Image> read() {
    if (bytes_.size() < kFileHeader) return error(0, "the file ends inside its header");
    const unsigned magic = u16(0);
    if (magic < 0x8300 || magic > 0x8304)
      return error(0, "the magic number must be 0x8300 to 0x8304 (H8/300 family); H8S has 0x8302");
    image_.normal_mode = magic != 0x8301 && magic != 0x8302;
    const std::size_t sections = u16(2), optional = u16(16);
    symbols_at_ = u32(8);
    symbol_count_ = u32(12);
    if (symbol_count_ != 0 && !fits(symbols_at_, symbol_count_ * kSymbol))
      return error(8, "the symbol table lies outside the file");
    if (symbol_count_ != 0) strings_at_ = symbols_at_ + symbol_count_ * kSymbol;
    if (optional >= kEntryAt + 4 && fits(kFileHeader, optional))
      image_.entry = u32(kFileHeader + kEntryAt);
    KAZ_TRY(read_symbols());
    for (std::size_t k = 0; k < sections; ++k) {
      const std::size_t at = kFileHeader + optional + k * kSectionHeader;
      if (!fits(at, kSectionHeader)) return error(at, "the file ends inside a section header");
      KAZ_TRY(read_section(at));
    }
    if (image_.segments.empty()) return error(0, "no section with contents");
    image_.symbols = SymbolTable(std::move(symbols_), std::move(lines_));
    return std::move(image_);
  }

 private:
  struct Function {
    std::string file;
    std::uint32_t address = 0;
    std::uint32_t first_line = 0;
  };

  // Eight bytes of name, or zero and an offset into the string table.
  std::string name_at(std::size_t at, std::size_t max_length) const {
    if (u32(at) != 0) return text(at, max_length);
    return text(strings_at_ + u32(at + 4), kLongestName);
  }

  Result<void> read_symbols() {
    std::string file;
    std::uint32_t current = 0;  // symbol index of the function that .bf belongs to
    for (std::uint32_t k = 0; k < symbol_count_; ++k) {
      const std::size_t at = symbols_at_ + k * kSymbol;
      const unsigned section = u16(at + 12), type = u16(at + 14), storage = bytes_[at + 16];
      const std::uint32_t further = bytes_[at + 17], value = u32(at + 8);
      if (further > symbol_count_ - k - 1)
        return error(at, "a symbol's auxiliary entries lie outside the table");
      const std::string symbol = name_at(at, 8);
      const std::size_t extra = at + kSymbol;
      const bool function = (type & 0x30) == kFunctionType;
      if (storage == kFileName && further > 0) file = name_at(extra, kSymbol);
      if (storage == kFunctionMark && symbol == ".bf" && further > 0)
        functions_[current].first_line = u16(extra + 4);
      if ((storage == kExternal || storage == kStatic) && section > 0 && section < 0xfff0 &&
          !symbol.empty() && symbol[0] != '.') {
        // A function's first further entry: tag, then the bytes of its code.
        const std::uint32_t size = function && further > 0 ? u32(extra + 4) : 0;
        symbols_.push_back({symbol, value, function, size});
        if (function) {
          current = k;
          functions_[k] = {file, value, 0};
        }
      }
      k += further;
    }
    return {};
  }

  Result<void> read_section(std::size_t at) {
    const std::uint32_t load = u32(at + 8), run = u32(at + 12), size = u32(at + 16),
                        where = u32(at + 20);
    const std::uint32_t lines_at = u32(at + 28), flags = u32(at + 36);
    const std::size_t lines = u16(at + 34);
    const std::string name = text(at, 8);
    if (where != 0 && size != 0 && !(flags & kNotInMemory)) {
      if (auto ok = add(at, "section " + name, {load, run, name, {}}, where, size); !ok) return ok;
    }
    if (lines == 0) return {};
    if (!fits(lines_at, lines * kLine))
      return error(at, "the line numbers of section " + name + " lie outside the file");
    read_lines(lines_at, lines);
    return {};
  }

  // Line 0 names a function by its symbol; the following ones count from the function's first line.
  void read_lines(std::size_t at, std::size_t count) {
    const Function* function = nullptr;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t value = u32(at + k * kLine), line = u32(at + k * kLine + 4);
      if (line == 0) {
        const auto found = functions_.find(value);
        function = found == functions_.end() ? nullptr : &found->second;
        if (function) lines_.push_back({function->address, function->file, function->first_line});
      } else if (function) {
        lines_.push_back({value, function->file, function->first_line + line - 1});
      }
    }
  }

  std::size_t symbols_at_ = 0, symbol_count_ = 0, strings_at_ = 0;
  std::map<std::uint32_t, Function> functions_;
  std::vector<SourceLine> lines_;
};

}  // namespace

Result<Image> parse_coff(std::span<const std::uint8_t> bytes, const std::string& name) {
  return Reader(bytes, name).read();
}

}  // namespace kaz::h8s
