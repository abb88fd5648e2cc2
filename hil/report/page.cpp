// Style and frame of the pages.
// SPDX-License-Identifier: Apache-2.0
#include "hil/report/page.h"

#include <cstdio>

#include "shared/base/xml_text.hpp"

namespace kaz::hil {
namespace {

const char* const kStyle = R"(
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 72em; padding: 0 1em;
       color: #222; background: #fff }
h1 { font-size: 1.5em; margin-bottom: .2em } h2 { font-size: 1.15em; margin-top: 2em }
.facts { color: #555 } table { border-collapse: collapse; width: 100% }
th { text-align: left; border-bottom: 2px solid #888; padding: .3em .6em }
td { border-bottom: 1px solid #ddd; padding: .3em .6em; vertical-align: top }
td.number { text-align: right; white-space: nowrap } code { font-size: .92em }
.passed { color: #176b2c } .failed { color: #b00020; font-weight: 600 } .out { color: #777 }
tr.failed-row td { background: #fdf1f2; font-weight: normal; color: #222 }
pre { background: #f5f5f5; padding: .6em; overflow-x: auto; font-size: .85em; white-space: pre-wrap }
@media print { pre { white-space: pre-wrap } }
)";

}  // namespace

std::string fixed(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string joined(const std::vector<std::string>& lines, const char* between) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : between) + line;
  return text;
}

std::string page_head(const std::string& title, const std::string& more_style) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>" +
         xml_text(title) + "</title>\n<style>" + kStyle + more_style + "</style></head><body>\n";
}

std::string table_cells(const std::vector<std::string>& texts, const char* cell) {
  std::string cells;
  for (const std::string& text : texts)
    cells += std::string("<") + cell + ">" + xml_text(text) + "</" + cell + ">";
  return cells;
}

std::string table_row(const std::vector<std::string>& texts, const char* cell) {
  return "<tr>" + table_cells(texts, cell) + "</tr>\n";
}

const char* verdict_class(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "passed";
    case Verdict::failed:
      return "failed";
    default:
      return "out";
  }
}

std::string verdict_cell(Verdict verdict) {
  return std::string("<td class=\"") + verdict_class(verdict) + "\">" + verdict_text(verdict) +
         "</td>";
}

const char* row_begin(Verdict verdict) {
  return verdict == Verdict::failed ? "<tr class=\"failed-row\">" : "<tr>";
}

}  // namespace kaz::hil
