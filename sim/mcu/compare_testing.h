// For tests: compares the native engine with the emulator on the built firmware image.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "sim/mcu/compare.h"

namespace kaz::sim {

inline CompareOptions firmware_comparison(std::int64_t ticks) {
  CompareOptions options;
  options.image_path = KAZ_FIRMWARE_IMAGE;
  options.ticks = ticks;
  return options;
}

// Runs the comparison. If the comparison cannot run, the test fails and the report is empty.
inline CompareReport compare_or_fail(const CompareOptions& options) {
  const auto report = compare_engines(options);
  EXPECT_TRUE(report) << report.error().message;
  return report ? *report : CompareReport{};
}

}  // namespace kaz::sim
