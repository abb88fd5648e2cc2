// Common parts of HTML reports: style, frame and cells.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/report/verdict.h"

namespace kaz::hil {

std::string fixed(double value, int digits);
std::string joined(const std::vector<std::string>& lines, const char* between);

// Returns the beginning of the page, up to and including the start tag of the body. The page is
// self-contained: the page has no script and fetches nothing. `more_style` is additional CSS for this page.
std::string page_head(const std::string& title, const std::string& more_style = {});
inline constexpr const char* kPageEnd = "</body></html>\n";

// table_cells() returns the cells of a table row. table_row() returns the whole row. Texts are escaped.
// `cell` is "td" or "th".
std::string table_cells(const std::vector<std::string>& texts, const char* cell = "td");
std::string table_row(const std::vector<std::string>& texts, const char* cell = "td");

// Returns the CSS class for the color of a verdict: "passed", "failed" or "out".
const char* verdict_class(Verdict verdict);
// Returns a table cell with the verdict as text.
std::string verdict_cell(Verdict verdict);
// Returns the start tag of a table row. A row of a failure is highlighted.
const char* row_begin(Verdict verdict);

}  // namespace kaz::hil
