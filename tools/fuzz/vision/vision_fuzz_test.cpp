// Every seed of vision's fuzz targets, damaged seeds, and inputs made at random, as ordinary tests.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "tools/fuzz/vision/targets.h"

namespace kaz::fuzz {
namespace {

namespace fs = std::filesystem;
using Input = std::vector<std::uint8_t>;

std::vector<Input> seeds(const Target& target) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(fs::path(KAZ_VISION_SEEDS) / target.name))
    paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Input> inputs;
  for (const fs::path& path : paths) {
    std::ifstream file(path, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return inputs;
}

void damage(Input& input, std::mt19937& random) {
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

class VisionFuzz : public testing::TestWithParam<Target> {};

TEST_P(VisionFuzz, Seeds) {
  const std::vector<Input> all = seeds(GetParam());
  EXPECT_FALSE(all.empty());
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_EQ(GetParam().run(all[i]).value_or(""), "") << "seed " << i << " by name";
}

// A fixed stream; the fuzzer finds better ones, but not in every build.
TEST_P(VisionFuzz, DamagedSeedsAndNoise) {
  const bool frames = std::string(GetParam().name) == "vision";
  const std::vector<Input> all = seeds(GetParam());
  std::mt19937 random(11);
  for (int k = 0; k < (frames ? 300 : 2000); ++k) {
    Input input = all[random() % all.size()];
    if (random() % 4 == 0) {
      input.resize(random() % 400);
      for (std::uint8_t& byte : input) byte = static_cast<std::uint8_t>(random());
    }
    damage(input, random);
    ASSERT_EQ(GetParam().run(input).value_or(""), "") << "case " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, VisionFuzz, testing::ValuesIn(kVisionTargets),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace kaz::fuzz
