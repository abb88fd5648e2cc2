// Every seed of the flash writer's fuzz target, damaged seeds, and cases made at random.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "tools/fuzz/flash_writer/flash_writer.h"

namespace kaz::fuzz {
namespace {

namespace fs = std::filesystem;
using Input = std::vector<std::uint8_t>;

std::vector<std::pair<std::string, Input>> seeds() {
  std::vector<std::pair<std::string, Input>> inputs;
  for (const auto& entry : fs::directory_iterator(KAZ_FLASH_WRITER_SEEDS)) {
    std::ifstream file(entry.path(), std::ios::binary);
    inputs.emplace_back(entry.path().filename().string(),
                        Input{std::istreambuf_iterator<char>(file), {}});
  }
  std::ranges::sort(inputs);
  return inputs;
}

void judge(const Input& input, const std::string& name) {
  const auto complaint = try_flash_writer(input);
  ASSERT_EQ(complaint.value_or(""), "") << name << "\n" << flash_writer_text(input);
}

TEST(FlashWriterFuzz, Seeds) {
  const auto all = seeds();
  ASSERT_FALSE(all.empty());
  for (const auto& [name, input] : all) judge(input, name);
}

// A fixed stream; the fuzzer finds better ones, but not in every build.
TEST(FlashWriterFuzz, DamagedSeedsAndNoise) {
  const auto all = seeds();
  ASSERT_FALSE(all.empty());
  std::mt19937 random(18);
  for (int k = 0; k < 60; ++k) {
    Input input = all[random() % all.size()].second;
    if (k % 2 == 0) {
      input.resize(20 + random() % 200);
      for (std::uint8_t& byte : input) byte = static_cast<std::uint8_t>(random());
    }
    for (unsigned changes = 1 + random() % 4; changes > 0 && !input.empty(); --changes)
      input[random() % input.size()] = static_cast<std::uint8_t>(random());
    judge(input, "case " + std::to_string(k));
  }
}

}  // namespace
}  // namespace kaz::fuzz
