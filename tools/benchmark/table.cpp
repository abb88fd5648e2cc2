// Table and JSON of the results.
// SPDX-License-Identifier: Apache-2.0
#include "tools/benchmark/benchmark.h"

#include <unistd.h>

#include <cstdio>

#include <nlohmann/json.hpp>

#include "shared/base/files.hpp"
#include "tools/benchmark/engines.h"

namespace kaz::bench {
namespace {

struct Row {
  const Name* name;
  std::string spoken;  // with the engine
  double value;
};

std::vector<Row> rows(const Results& results, const std::vector<std::string>& engines) {
  std::vector<Row> found;
  for (const Name& name : names()) {
    const std::string& plain = name.name;
    if (const auto value = results.get(plain)) found.push_back({&name, plain, *value});
    for (const auto& engine : engines) {
      const std::string spoken = named(plain, engine);
      if (spoken == plain) continue;
      if (const auto value = results.get(spoken)) found.push_back({&name, spoken, *value});
    }
  }
  return found;
}

std::string number(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

// "due 300, aim 1000" as columns, and which of the two is reached.
std::string verdict(const Row& row) {
  const auto reached = [&row](double wanted) {
    return row.name->more_is_better ? row.value >= wanted : row.value <= wanted;
  };
  if (row.name->due == 0) return "";
  if (row.name->aim != 0 && reached(row.name->aim)) return "aim reached";
  return reached(row.name->due) ? "reached" : "NOT REACHED";
}

std::string wanted(double value) {
  if (value == 0) return "";
  char text[64];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

std::string table(const Results& results, const std::vector<std::string>& engines) {
  const auto all = rows(results, engines);
  std::size_t width = 4;
  for (const Row& row : all) width = std::max(width, row.spoken.size());
  const int w = static_cast<int>(width);
  char line[256];
  std::snprintf(line, sizeof line, "%-*s %10s  %-10s %8s %8s\n", w, "name", "measured", "unit",
                "due", "aim");
  std::string text = line;
  for (const Row& row : all) {
    std::snprintf(line, sizeof line, "%-*s %10s  %-10s %8s %8s  %s", w, row.spoken.c_str(),
                  number(row.value, row.name->decimals).c_str(), row.name->unit.c_str(),
                  wanted(row.name->due).c_str(), wanted(row.name->aim).c_str(),
                  verdict(row).c_str());
    std::string row_text = line;
    row_text.erase(row_text.find_last_not_of(' ') + 1);
    text += row_text + "\n";
  }
  text += "emulator: if a name does not end with the name of an engine, the engine is " +
          engine_names().front() +
          "; counts of states are exact; times are CPU times of this process\n";
  for (const auto& remark : results.remarks()) text += remark + "\n";
  return text;
}

Result<void> write_json(const std::string& path, const Results& results,
                        const std::vector<std::string>& engines) {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (const Row& row : rows(results, engines)) object[row.spoken] = row.value;
  return write_whole_file(path, object.dump(2) + "\n");
}

}  // namespace kaz::bench
