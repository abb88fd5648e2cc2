// Digests of pictures, against what `xxhsum -H2` prints of files with these bytes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/picture_digest.h"

#include <gtest/gtest.h>

#include <vector>

namespace kaz::sim {
namespace {

TEST(PictureDigest, IsWhatXxhsumPrints) {
  EXPECT_EQ(picture_digest({}), "99aa06d3014798d86001c324468d497f");
  const std::vector<std::uint8_t> three{0xff, 0x00, 0x80};
  EXPECT_EQ(picture_digest(three), "75ab0f934b5f324d2a8aedc0894ed6ee");
  std::vector<std::uint8_t> many(1000);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = static_cast<std::uint8_t>(7 * i);
  EXPECT_EQ(picture_digest(many), "abee229cdadad76d10ad30264426c830");
  many[999] ^= 1;
  EXPECT_NE(picture_digest(many), "abee229cdadad76d10ad30264426c830");
}

}  // namespace
}  // namespace kaz::sim
