// Every seed of vision's fuzz targets, damaged seeds, and inputs made at random, as ordinary tests.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "tools/fuzz/seeds_test.h"
#include "tools/fuzz/vision/targets.h"

namespace kaz::fuzz {
namespace {

// Frames take longer than files, of which more than the 200 of Seeds are affordable.
TEST_P(Seeds, ManyDamagedFiles) {
  if (std::string(GetParam().name) == "vision") GTEST_SKIP() << "frames take too long";
  const auto seeds = seeds_of(GetParam().name);
  ASSERT_FALSE(seeds.empty());
  std::mt19937 random(12);
  for (int k = 0; k < 2000; ++k) {
    Input input = seeds[random() % seeds.size()].second;
    damage(input, random);
    ASSERT_EQ(GetParam().run(input).value_or(""), "") << "case " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Vision, Seeds, testing::ValuesIn(kVisionTargets),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace kaz::fuzz
