// Digests of pictures, against RFC 8439 computed with Python's integers.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/picture_digest.h"

#include <gtest/gtest.h>

#include <vector>

namespace kaz::sim {
namespace {

TEST(PictureDigest, IsPoly1305WithTheFixedKey) {
  EXPECT_EQ(picture_digest({}).value(), "101112131415161718191a1b1c1d1e1f");
  const std::vector<std::uint8_t> three{0xff, 0x00, 0x80};
  EXPECT_EQ(picture_digest(three).value(), "784a2d921497199c1ea123a628ab2db0");
  std::vector<std::uint8_t> many(1000);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = static_cast<std::uint8_t>(7 * i);
  EXPECT_EQ(picture_digest(many).value(), "c101423b6c66ee591d4c2448293c728d");
  many[999] ^= 1;
  EXPECT_NE(picture_digest(many).value(), "c101423b6c66ee591d4c2448293c728d");
}

}  // namespace
}  // namespace kaz::sim
