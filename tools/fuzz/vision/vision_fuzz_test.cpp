// Every seed of vision's fuzz targets, damaged seeds, and inputs made at random, as ordinary tests.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tools/fuzz/seeds_test.h"
#include "tools/fuzz/vision/targets.h"

namespace kaz::fuzz {
namespace {

INSTANTIATE_TEST_SUITE_P(Vision, Seeds, testing::ValuesIn(kVisionTargets),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace kaz::fuzz
