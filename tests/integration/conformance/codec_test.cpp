// The suite's own codec against the bytes that docs/reference/protocol.md shows.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "hil/conformance/codec.h"

namespace kaz::hil {
namespace {

const Bytes kState{0x00, 0x04, 0x01, 0x05, 0x05, 0x83, 0xac, 0xd1, 0x00};

int frames_in(Deframer& deframer, const Bytes& wire) {
  int frames = 0;
  for (const std::uint8_t byte : wire) frames += deframer.take(byte, Time::zero()).has_value();
  return frames;
}

TEST(ConformanceCodec, CheckValueOfTheStandard) {
  EXPECT_EQ(crc_of({'1', '2', '3', '4', '5', '6', '7', '8', '9'}), 0x29B1);
}

TEST(ConformanceCodec, MakesTheExamplesOfThePage) {
  EXPECT_EQ(frame_of(1, 5, 5, {}), kState);
  const Bytes targets{0x00, 0x04, 0x01, 0x03, 0x07, 0x01, 0x01, 0x08, 0x03, 0x01,
                      0xf4, 0x03, 0xe8, 0xff, 0xfe, 0x80, 0xa6, 0xa2, 0x00};
  EXPECT_EQ(frame_of(1, 3, 7, {0, 0, 0, 3, 0x01, 0xf4, 0x03, 0xe8, 0xff, 0xfe}), targets);
}

TEST(ConformanceCodec, TakesFramesApart) {
  Deframer deframer;
  const Bytes fields{0, 0, 7, 0};
  std::optional<Frame> got;
  for (const std::uint8_t byte : frame_of(14, 0x85, 255, fields)) {
    if (auto frame = deframer.take(byte, Time(5))) got = frame;
  }
  ASSERT_TRUE(got);
  EXPECT_EQ(got->address, 14);
  EXPECT_EQ(got->type, 0x85);
  EXPECT_EQ(got->sequence, 255);
  EXPECT_EQ(got->fields, fields);
  EXPECT_EQ(got->at, Time(5));
  EXPECT_EQ(deframer.faults(), 0);
}

TEST(ConformanceCodec, SeesWhatIsWrongWithFrames) {
  Deframer valid;
  EXPECT_EQ(frames_in(valid, kState), 1);
  EXPECT_EQ(frames_in(valid, kState), 1);
  EXPECT_EQ(valid.faults(), 0);

  Deframer shared_zero;
  EXPECT_EQ(frames_in(shared_zero, kState), 1);
  EXPECT_EQ(frames_in(shared_zero, {kState.begin() + 1, kState.end()}), 0);
  EXPECT_GT(shared_zero.faults(), 0);

  Deframer damaged;
  Bytes wrong = kState;
  wrong[3] ^= 1;
  EXPECT_EQ(frames_in(damaged, wrong), 0);
  EXPECT_EQ(damaged.faults(), 1);
}

}  // namespace
}  // namespace kaz::hil
