// Reads section headers and symbols of an ELF file.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/session/plugin_symbol.h"

#include <cxxabi.h>
#include <elf.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>

#include "shared/base/files.hpp"

namespace kaz::tools {
namespace {

template <class T>
std::optional<T> at(std::string_view file, std::uint64_t offset) {
  if (offset > file.size() || file.size() - offset < sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, file.data() + offset, sizeof value);
  return value;
}

std::string demangled(const char* symbol) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(
      abi::__cxa_demangle(symbol, nullptr, nullptr, &status), std::free);
  return status == 0 ? text.get() : symbol;
}

// The name in a string table; empty where it does not end within the file.
std::string name_in(std::string_view file, const Elf64_Shdr& names, std::uint32_t offset) {
  if (names.sh_offset > file.size() || offset > file.size() - names.sh_offset) return {};
  const std::string_view rest = file.substr(names.sh_offset + offset);
  const auto end = rest.find('\0');
  return end == std::string_view::npos ? std::string() : std::string(rest.substr(0, end));
}

std::string function_in(std::string_view file, std::uint64_t offset) {
  const auto header = at<Elf64_Ehdr>(file, 0);
  if (!header || std::memcmp(header->e_ident, ELFMAG, SELFMAG) != 0 ||
      header->e_ident[EI_CLASS] != ELFCLASS64)
    return {};
  const auto section = [&](std::uint64_t number) {
    return at<Elf64_Shdr>(file, header->e_shoff + number * sizeof(Elf64_Shdr));
  };
  for (std::uint64_t i = 0; i < header->e_shnum; ++i) {
    const auto table = section(i);
    if (!table || table->sh_type != SHT_SYMTAB) continue;
    const auto names = section(table->sh_link);
    for (std::uint64_t k = 0; names && k < table->sh_size / sizeof(Elf64_Sym); ++k) {
      const auto symbol = at<Elf64_Sym>(file, table->sh_offset + k * sizeof(Elf64_Sym));
      if (!symbol) break;
      // At 0 is the file's header; mold lists functions there that it left out.
      if (ELF64_ST_TYPE(symbol->st_info) != STT_FUNC || symbol->st_value == 0 ||
          offset < symbol->st_value || offset - symbol->st_value >= symbol->st_size)
        continue;
      return demangled(name_in(file, *names, symbol->st_name).c_str());
    }
  }
  return {};
}

}  // namespace

std::string function_at(const std::string& path, std::uint64_t offset) {
  constexpr std::size_t kMaxBytes = 256 << 20;
  const auto file = read_whole_file(path, kMaxBytes, "it is a plug-in");
  return file ? function_in(*file, offset) : std::string();
}

}  // namespace kaz::tools
