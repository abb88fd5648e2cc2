// Sums and validation of flow's cells with the processor's vectors and without.
// SPDX-License-Identifier: Apache-2.0
#include "vision/flow/flow_cells.h"

#include <gtest/gtest.h>

#include <vector>

#include "shared/base/random.hpp"

namespace kaz::vision {
namespace {

struct Certainties {
  std::vector<float> xx, xy, yy;
};

// Of two noisy pictures, a tenth of which was not compared.
Certainties certainties(int width, int height, bool vectors) {
  Random random(3);
  FlowProducts products(vectors);
  products.resize(width, height);
  const auto columns = static_cast<std::size_t>(width);
  std::vector<std::vector<float>> rows;
  for (int y = 0; y < height; ++y) {
    rows.emplace_back();
    for (int x = 0; x < width; ++x) rows.back().push_back(static_cast<float>(random.below(256)));
  }
  for (int y = 1; y + 1 < height; ++y) {
    std::vector<float> there, compared;
    const auto v = static_cast<std::size_t>(y);
    for (const float code : rows[v]) {
      compared.push_back(random.chance(0.9) ? 1.0F : 0.0F);
      there.push_back(compared.back() * (code + static_cast<float>(20 * random.uniform())));
    }
    products.set_row(y, rows[v - 1].data(), rows[v].data(), rows[v + 1].data(), there.data(),
                     compared.data());
  }
  Certainties all;
  for (int y = 0; y < height; ++y) {
    std::vector<float> xx(columns), xy(columns), yy(columns);
    judge_flow_row(products.sum_row(y), products.compared(y), width, {0.35F, 0.0225F, 0.0625F},
                   {xx.data(), xy.data(), yy.data()}, vectors);
    all.xx.insert(all.xx.end(), xx.begin(), xx.end());
    all.xy.insert(all.xy.end(), xy.begin(), xy.end());
    all.yy.insert(all.yy.end(), yy.begin(), yy.end());
  }
  return all;
}

TEST(FlowCells, AreTheSameWithoutVectors) {
  for (const int width : {16, 17, 81}) {
    const Certainties with = certainties(width, 40, true), without = certainties(width, 40, false);
    EXPECT_EQ(with.xx, without.xx);
    EXPECT_EQ(with.xy, without.xy);
    EXPECT_EQ(with.yy, without.yy);
    std::size_t valid = 0;
    for (const float x : with.xx) valid += x > 0 ? 1 : 0;
    EXPECT_GT(valid, with.xx.size() / 10);
    EXPECT_LT(valid, with.xx.size());
  }
}

}  // namespace
}  // namespace kaz::vision
