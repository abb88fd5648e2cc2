// The two loops over pixels with the processor's vectors and without, on numbers of all kinds.
// SPDX-License-Identifier: Apache-2.0
#include "vision/planes/plane_rows.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "shared/base/random.hpp"

namespace kaz::vision {
namespace {

std::vector<float> row(std::size_t pixels, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> d(pixels);
  for (float& x : d) {
    x = static_cast<float>(60 * random.uniform());
    if (random.chance(0.1)) x = 0;
    if (random.chance(0.02)) x = -1;
    if (random.chance(0.02)) x = std::numeric_limits<float>::infinity();
    if (random.chance(0.02)) x = std::numeric_limits<float>::quiet_NaN();
  }
  return d;
}

TEST(PlaneRows, SumsAreTheSameWithoutVectors) {
  for (const std::size_t n : {std::size_t{1}, std::size_t{7}, std::size_t{317}}) {
    std::vector<float> sum[2], min[2], max[2];
    std::vector<int> count[2];
    for (const int vectors : {0, 1}) {
      sum[vectors].assign(n, 0);
      min[vectors].assign(n, kMaxDisparity_px);
      max[vectors].assign(n, 0);
      count[vectors].assign(n, 0);
      for (std::uint64_t seed = 1; seed < 9; ++seed)
        add_row(
            row(n, seed).data(), n,
            {sum[vectors].data(), min[vectors].data(), max[vectors].data(), count[vectors].data()},
            vectors == 1);
    }
    EXPECT_EQ(sum[0], sum[1]);
    EXPECT_EQ(min[0], min[1]);
    EXPECT_EQ(max[0], max[1]);
    EXPECT_EQ(count[0], count[1]);
  }
}

TEST(PlaneRows, LabelsAreTheSameWithoutVectors) {
  for (const std::size_t n : {std::size_t{1}, std::size_t{7}, std::size_t{317}}) {
    std::vector<std::uint8_t> label[2];
    std::vector<float> square[2];
    std::vector<int> count[2];
    for (const int vectors : {0, 1}) {
      label[vectors].assign(n, 9);
      square[vectors].assign(n, 0);
      count[vectors].assign(n, 0);
      for (std::uint64_t seed = 1; seed < 9; ++seed)
        label_row(row(n, seed).data(), n, {20.3F, 0.07F, 6, 3}, label[vectors].data(),
                  square[vectors].data(), count[vectors].data(), vectors == 1);
    }
    EXPECT_EQ(label[0], label[1]);
    EXPECT_EQ(square[0], square[1]);
    EXPECT_EQ(count[0], count[1]);
  }
}

}  // namespace
}  // namespace kaz::vision
