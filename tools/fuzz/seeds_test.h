// Runs fuzz targets as ordinary tests in every build: on their seeds, on damaged seeds, and on noise.
// tools/fuzz/targets.txt lists the folders of seeds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tools/fuzz/target.h"

namespace kaz::fuzz {

using Input = std::vector<std::uint8_t>;

// Returns the folder of a target's seeds, from the manifest. Empty: the target is not listed.
inline std::string seeds_folder(const std::string& target) {
  std::ifstream manifest(KAZ_TREE "/tools/fuzz/targets.txt");
  for (std::string line; std::getline(manifest, line);) {
    std::istringstream words(line);
    std::string kind, name, folder;
    if (words >> kind >> name >> folder && kind == "target" && name == target)
      return KAZ_TREE "/" + folder;
  }
  return "";
}

inline std::vector<std::pair<std::string, Input>> seeds_of(const std::string& target) {
  namespace fs = std::filesystem;
  std::vector<std::pair<std::string, Input>> seeds;
  const std::string folder = seeds_folder(target);
  if (folder.empty() || !fs::is_directory(folder)) return seeds;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    seeds.emplace_back(entry.path().filename().string(),
                       Input(std::istreambuf_iterator<char>(file), {}));
  }
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

inline void damage(Input& input, std::mt19937& random) {
  for (unsigned changes = 1 + random() % 4; changes > 0 && !input.empty(); --changes) {
    const std::size_t at = random() % input.size();
    switch (random() % 5) {
      case 0:
        input[at] = static_cast<std::uint8_t>(random());
        break;
      case 1:
        input[at] = static_cast<std::uint8_t>(input[at] ^ (1U << (random() % 8)));
        break;
      case 2:
        input.resize(at);
        break;
      case 3:
        input.erase(input.begin() + static_cast<std::ptrdiff_t>(at));
        break;
      default:
        input.insert(input.begin() + static_cast<std::ptrdiff_t>(at),
                     static_cast<std::uint8_t>(random()));
    }
  }
}

class Seeds : public testing::TestWithParam<Target> {};

TEST_P(Seeds, AsTheyAre) {
  const auto seeds = seeds_of(GetParam().name);
  EXPECT_FALSE(seeds.empty()) << "tools/fuzz/targets.txt names no folder with seeds";
  for (const auto& [name, input] : seeds)
    EXPECT_EQ(GetParam().run(input).value_or(""), "") << "seed " << name;
}

// Uses a fixed sequence of random numbers. The fuzzer finds better inputs, but does not run in every build.
TEST_P(Seeds, DamagedAndNoise) {
  const auto seeds = seeds_of(GetParam().name);
  ASSERT_FALSE(seeds.empty());
  std::mt19937 random(11);
  for (int k = 0; k < GetParam().damaged_cases; ++k) {
    Input input = seeds[random() % seeds.size()].second;
    if (random() % 4 == 0) {
      input.resize(random() % 400);
      for (std::uint8_t& byte : input) byte = static_cast<std::uint8_t>(random());
    }
    damage(input, random);
    ASSERT_EQ(GetParam().run(input).value_or(""), "") << "case " << k;
  }
}

}  // namespace kaz::fuzz
