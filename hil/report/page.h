// What the HTML pages of reports have in common: style, frame, cells.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/report/verdict.h"

namespace kaz::hil {

std::string fixed(double value, int digits);
std::string joined(const std::vector<std::string>& lines, const char* between);

// From the first line to <body>. Self-contained: no script, nothing fetched. `more_style`: CSS of
// this page alone.
std::string page_head(const std::string& title, const std::string& more_style = {});
inline constexpr const char* kPageEnd = "</body></html>\n";

// Cells of a table's row, and a row of them alone; their text is escaped. `cell`: "td" or "th".
std::string table_cells(const std::vector<std::string>& texts, const char* cell = "td");
std::string table_row(const std::vector<std::string>& texts, const char* cell = "td");

// "passed", "failed", "out": class of what stands in the verdict's colour.
const char* verdict_class(Verdict verdict);
// A table's cell with the verdict in words.
std::string verdict_cell(Verdict verdict);
// The begin of a table's row; that of a failed one stands out.
const char* row_begin(Verdict verdict);

}  // namespace kaz::hil
