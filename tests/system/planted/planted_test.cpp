// A planted bug must be found by the comparison of the engines. The native engine linked here is the
// planted one too: only the widths of int differ.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sim/mcu/compare.h"

namespace kaz::sim {
namespace {

TEST(Planted, BugIsFound) {
  CompareOptions options;
  options.image_path = PLANTED_IMAGE;
  options.ticks = 100000;
  options.seed = 1;
  const auto report = compare_engines(options);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_FALSE(report->equal());
  ASSERT_TRUE(report->tick);
  EXPECT_FALSE(report->differences.empty());
  EXPECT_FALSE(report->input_hex.empty());
  std::printf("%s\n", report->text().c_str());
}

}  // namespace
}  // namespace kaz::sim
