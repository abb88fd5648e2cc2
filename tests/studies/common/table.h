// Markdown tables of the studies.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace kaz::studies {

// Formats like snprintf, at most 511 bytes.
template <class... T>
std::string text(const char* format, T... values) {
  char line[512];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

// Returns `part` of `all` in percent; 0 if `all` is 0.
inline double percent(int part, int all) {
  return all > 0 ? 100.0 * part / all : 0;
}

class MarkdownTable {
 public:
  explicit MarkdownTable(std::vector<std::string> columns) : columns_(std::move(columns)) {}

  // Adds a row. Missing cells at the end are empty.
  void add(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }
  // Returns the table with its heading. It ends with a newline.
  std::string text() const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace kaz::studies
