// Every seed of the targets of targets.h, damaged seeds, and noise, as ordinary tests.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tools/fuzz/inputs/targets.h"
#include "tools/fuzz/seeds_test.h"

namespace kaz::fuzz {
namespace {

INSTANTIATE_TEST_SUITE_P(Inputs, Seeds, testing::ValuesIn(kInputTargets),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace kaz::fuzz
