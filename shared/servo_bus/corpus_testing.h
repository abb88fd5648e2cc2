// Test helper: reads the register corpus in shared/feetech/corpus and shared/dynamixel/corpus.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "shared/servo_bus/registers.h"

namespace kaz::servo_bus::test {

struct CorpusRow {
  std::uint16_t address = 0;
  std::uint8_t size = 0, sign_bit = 0;
  bool writable = false, eeprom = false;
  std::optional<int> factory;  // nullopt: the register changes by itself
  int min = 0, max = 0;
  std::string what;
};

// Returns the corpus of a known model. Fails the test if the file of the corpus is missing.
inline std::vector<CorpusRow> corpus_of(const std::string& model) {
  const std::string folder(name_of(find_model(model)->protocol));
  std::ifstream file("shared/" + folder + "/corpus/" + model + ".csv");
  EXPECT_TRUE(file) << model;
  std::vector<CorpusRow> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::vector<std::string> cell(9);
    for (std::string& one : cell) std::getline(cells, one, ',');
    const auto number = [&](std::size_t i) { return cell[i].empty() ? 0 : std::stoi(cell[i]); };
    CorpusRow row;
    row.address = static_cast<std::uint16_t>(number(0));
    row.size = static_cast<std::uint8_t>(number(1));
    row.writable = cell[2] == "RW";
    row.eeprom = cell[3] == "EEPROM";
    if (cell[4] != "-") row.factory = number(4);
    row.min = number(5);
    row.max = number(6);
    row.sign_bit = static_cast<std::uint8_t>(number(7));
    row.what = cell[8];
    rows.push_back(row);
  }
  return rows;
}

}  // namespace kaz::servo_bus::test
