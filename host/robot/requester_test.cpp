// What requests look like on the wire.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/requester.h"

#include <gtest/gtest.h>

#include <random>

#include "host/robot/test_board.h"

namespace kaz::host {
namespace {

// About 20 of so many random ones would (frame.h).
TEST(Requester, SendsNoFrameThatOneDamagedByteCouldSplit) {
  TestBoard board;
  int frames = 0, splits = 0;
  board.to_board = [&](TestBoard::Bytes wire) {
    ++frames;
    splits += kz_frame_splits(wire.data(), static_cast<u8>(wire.size()));
    return TestBoard::Bytes{};
  };
  Requester requester(board, board, {});
  std::mt19937 random(1);
  for (int i = 0; i < 30000; ++i) {
    kz_targets targets{};
    targets.mask = KZ_ALL_JOINTS;
    for (s16& angle : targets.angle) angle = static_cast<s16>(random());
    Request request;
    request.type = KZ_TYPE_targets;
    request.fields.length = kz_pack_targets(&targets, request.fields.bytes.data());
    ASSERT_TRUE(requester.tell(request));
  }
  EXPECT_EQ(frames, 30000);
  EXPECT_EQ(splits, 0);
}

}  // namespace
}  // namespace kaz::host
