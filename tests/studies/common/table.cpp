// Markdown tables of the studies.
// SPDX-License-Identifier: Apache-2.0
#include "tests/studies/common/table.h"

namespace kaz::studies {
namespace {

std::string line(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text.append(" ").append(cell).append(" |");
  return text.append("\n");
}

}  // namespace

void MarkdownTable::add(std::vector<std::string> cells) {
  cells.resize(columns_.size());
  rows_.push_back(std::move(cells));
}

std::string MarkdownTable::text() const {
  std::string text = line(columns_) + line(std::vector<std::string>(columns_.size(), "---"));
  for (const auto& row : rows_) text += line(row);
  return text;
}

}  // namespace kaz::studies
