// Looking up symbols and source lines.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <numeric>

#include "shared/image/image.h"

namespace kaz::h8s {

SymbolTable::SymbolTable(std::vector<Symbol> symbols, std::vector<SourceLine> lines)
    : symbols_(std::move(symbols)), lines_(std::move(lines)) {
  // At one address functions come last, so that at() prefers them.
  std::stable_sort(symbols_.begin(), symbols_.end(), [](const Symbol& a, const Symbol& b) {
    return a.address != b.address ? a.address < b.address : a.function < b.function;
  });
  std::stable_sort(lines_.begin(), lines_.end(),
                   [](const SourceLine& a, const SourceLine& b) { return a.address < b.address; });
  by_name_.resize(symbols_.size());
  std::iota(by_name_.begin(), by_name_.end(), std::size_t{0});
  std::stable_sort(by_name_.begin(), by_name_.end(), [this](std::size_t a, std::size_t b) {
    return symbols_[a].name < symbols_[b].name;
  });
}

std::optional<std::uint32_t> SymbolTable::address_of(std::string_view name) const {
  const auto find = [this](std::string_view wanted) -> std::optional<std::uint32_t> {
    const auto at = std::lower_bound(
        by_name_.begin(), by_name_.end(), wanted,
        [this](std::size_t k, std::string_view w) { return symbols_[k].name < w; });
    if (at == by_name_.end() || symbols_[*at].name != wanted) return std::nullopt;
    return symbols_[*at].address;
  };
  if (const auto exact = find(name)) return exact;
  std::string underscored(1, '_');
  return find(underscored.append(name));
}

const Symbol* SymbolTable::at(std::uint32_t address) const {
  const auto after =
      std::upper_bound(symbols_.begin(), symbols_.end(), address,
                       [](std::uint32_t a, const Symbol& s) { return a < s.address; });
  return after == symbols_.begin() ? nullptr : &*(after - 1);
}

const SourceLine* SymbolTable::line_at(std::uint32_t address) const {
  const auto after =
      std::upper_bound(lines_.begin(), lines_.end(), address,
                       [](std::uint32_t a, const SourceLine& l) { return a < l.address; });
  return after == lines_.begin() ? nullptr : &*(after - 1);
}

std::string SymbolTable::describe(std::uint32_t address) const {
  char text[48];
  const Symbol* symbol = at(address);
  // Far behind the last symbol is somewhere else altogether.
  if (!symbol || address - symbol->address > 0x8000) {
    std::snprintf(text, sizeof text, "0x%06x", address & 0xffffff);
    return text;
  }
  std::string result = symbol->name;
  if (address != symbol->address) {
    std::snprintf(text, sizeof text, "+0x%x", address - symbol->address);
    result += text;
  }
  const SourceLine* line = line_at(address);
  if (line && line->address >= symbol->address)
    result.append(" (")
        .append(line->file)
        .append(":")
        .append(std::to_string(line->line))
        .append(")");
  return result;
}

}  // namespace kaz::h8s
