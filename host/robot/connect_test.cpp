// Robot::connect: the error for each cause of not finding a board.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/link/board_testing.h"
#include "host/link/lateness.h"
#include "host/link/requester.h"
#include "host/link/stalling_testing.h"
#include "host/robot/connect.h"
#include "host/robot/robot.h"

namespace kaz::host {
namespace {

std::string connect_error(TestBoard& board, const ConnectOptions& options = {}) {
  const auto robot = Robot::connect(board, board, options);
  if (robot) return "connected";
  EXPECT_EQ(robot.error().fault, Fault::environment);
  return robot.error().message;
}

TestBoard::Bytes framed(TestBoard::Bytes body) {
  TestBoard::Bytes wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

// A board whose identify_reply is `change`d.
void answer_with(TestBoard& board, std::function<void(kz_identify_reply&)> change) {
  board.to_host = [change](TestBoard::Bytes frame) {
    kz_receiver receiver;
    kz_receiver_init(&receiver);
    for (const std::uint8_t byte : frame) kz_receive(&receiver, byte, 0);
    kz_identify_reply reply{};
    EXPECT_TRUE(kz_unpack_identify_reply(&reply, receiver.body + KZ_HEADER_SIZE,
                                         static_cast<u8>(receiver.length - KZ_HEADER_SIZE)));
    change(reply);
    TestBoard::Bytes body(receiver.body, receiver.body + receiver.length);
    kz_pack_identify_reply(&reply, body.data() + KZ_HEADER_SIZE);
    return framed(body);
  };
}

TEST(Connect, NothingAnswers) {
  TestBoard board;
  board.mute = true;
  EXPECT_EQ(
      connect_error(board),
      "no board answers on test-port: check that the robot is powered, the cable is plugged in, no "
      "other program has the port open, and the baud rate is the board's (115200). After an "
      "interrupted update, the board waits in its loader: run `kaz flash write`; for a servo bus "
      "use `kaz bus status --robot feetech:test-port`");
}

// `kaz flash run` on a busy machine: 61 ms of lateness excuse no silent board, and repeat nothing. A board
// that does not answer in all tries does not run.
TEST(Connect, IdentificationBearsALatenessThatCannotHideABoard) {
  TestBoard board;
  board.mute = true;
  StallingLine line(board, board);
  LatenessMeter meter(line, line);
  line.stalls = 1;
  line.length = std::chrono::milliseconds(61);
  int attempts = 0;
  const Time begin = board.now();
  const auto silent = repeat_if_late(
      &meter,
      [&] {
        ++attempts;
        Requester requester(meter, meter, {});
        return identify_board(requester);
      },
      kIdentifyBears);
  EXPECT_FALSE(silent);
  EXPECT_EQ(attempts, 1);
  EXPECT_GE(meter.longest(), std::chrono::milliseconds(59));
  EXPECT_NE(meter.excuse(), "");
  EXPECT_EQ(meter.excuse(kIdentifyBears), "");
  EXPECT_GE(board.now() - begin, 2 * kIdentifyBears) << "the tries take longer than what is borne";

  // A board that answers is found, however late its reply is read.
  board.mute = false;
  line.stalls = 3;
  line.length = kIdentifyBears - std::chrono::milliseconds(1);
  Requester requester(meter, meter, {});
  EXPECT_TRUE(identify_board(requester));
}

TEST(Connect, SomethingElseAnswers) {
  TestBoard board;
  board.mute = true;
  board.to_board = [&](TestBoard::Bytes) {
    const std::uint8_t greeting[] = {'o', 'k', '\r', '\n'};
    board.inject(greeting);
    return TestBoard::Bytes{};
  };
  const std::string message = connect_error(board);
  EXPECT_NE(message.find("the device on test-port is not a Kaz board"), std::string::npos);
  EXPECT_NE(message.find("24 bytes came"), std::string::npos) << message;  // 6 tries of 4
  EXPECT_NE(message.find("6f 6b 0d 0a 6f 6b"), std::string::npos) << message;
}

// The chip's own boot mode answers every byte by a zero until it has measured the baud rate.
TEST(Connect, AChipInBootModeAnswersZeros) {
  TestBoard board;
  board.mute = true;
  board.to_board = [&](TestBoard::Bytes) {
    const std::uint8_t zero[] = {0};
    board.inject(zero);
    return TestBoard::Bytes{};
  };
  EXPECT_EQ(connect_error(board),
            "test-port: 6 bytes came, but no reply, and all bytes are zero; a chip in boot mode "
            "answers with zeros, for example after an interrupted update: run `kaz flash write`");
}

TEST(Connect, TheLineEchoes) {
  TestBoard board;
  board.mute = true;
  board.to_board = [&](TestBoard::Bytes bytes) {
    board.inject(bytes);
    return bytes;
  };
  EXPECT_NE(connect_error(board).find("echoes the bytes written to it"), std::string::npos);
}

TEST(Connect, AnotherAddress) {
  TestBoard board;
  ConnectOptions options;
  options.address = 3;
  EXPECT_NE(connect_error(board, options).find("a board answers at address 1: give --address 1"),
            std::string::npos);
}

TEST(Connect, AnotherProtocolVersion) {
  TestBoard board;
  answer_with(board, [](kz_identify_reply& reply) { reply.protocol_version = 9; });
  EXPECT_EQ(
      connect_error(board),
      "the board on test-port speaks protocol version 9, but this program accepts versions 2 and "
      "3: flash the firmware of this release, or use the program of the board's release");
}

// Boards that were flashed before version 3 go on working; what their firmware gets wrong is named.
TEST(Connect, TheVersionBefore) {
  TestBoard board;
  answer_with(board, [](kz_identify_reply& reply) { reply.protocol_version = 2; });
  Requester requester(board, board, {});
  const auto identity = identify_board(requester);
  ASSERT_TRUE(identity) << identity.error().message;
  EXPECT_EQ(
      firmware_fault(*identity),
      "the firmware (protocol 2) can acknowledge a repeated stop request without switching the "
      "motors off; flash the firmware of this release");
  board.to_host = nullptr;
  const auto present = identify_board(requester);
  ASSERT_TRUE(present) << present.error().message;
  EXPECT_EQ(firmware_fault(*present), "");
}

// A later version may have a longer reply; its version is still where it was.
TEST(Connect, AnotherProtocolVersionWithAnotherReply) {
  TestBoard board;
  board.mute = true;
  board.to_board = [&](TestBoard::Bytes request) {
    const std::uint8_t sequence = request[4];  // 00, stuffing, address, type, sequence
    board.inject(framed({1, 0x81, sequence, 0, 0, 0, 7, 4, 99, 99}));
    return TestBoard::Bytes{};
  };
  EXPECT_NE(connect_error(board).find("speaks protocol version 4"), std::string::npos);
}

TEST(Connect, AnotherRobot) {
  TestBoard board;
  answer_with(board, [](kz_identify_reply& reply) { reply.joints = 24; });
  EXPECT_NE(connect_error(board).find("drives 24 joints, but Kaz has 18"), std::string::npos);
}

TEST(Connect, LinkFails) {
  TestBoard board;
  board.link_failure = Error{Fault::environment, "port test-port was closed"};
  EXPECT_EQ(connect_error(board), "port test-port was closed");
}

TEST(Connect, FindsTheBoardThroughNoise) {
  TestBoard board;
  const std::uint8_t noise[] = {0x12, 0x00, 0xff, 0x80, 0x00, 0x33};
  board.inject(noise);
  EXPECT_EQ(connect_error(board), "connected");
}

TEST(FirmwareVersion, IsMajorAndMinor) {
  EXPECT_EQ(firmware_version_text(2), "0.2");
  EXPECT_EQ(firmware_version_text(0x010A), "1.10");
  EXPECT_EQ(build_text(0x1A2B), "00001a2b");
}

}  // namespace
}  // namespace kaz::host
