// Boards at any address are found, and put back as they were.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/find_boards.h"

#include <gtest/gtest.h>

#include "host/link/board_testing.h"
#include "host/robot/kept_board.h"
#include "host/robot/robot_testing.h"

namespace kaz::host {
namespace {

using Addresses = std::vector<std::uint8_t>;

// The test board at another address: what is sent to `address` reaches it, and its replies come from there.
TestBoard::Bytes readdressed(const TestBoard::Bytes& wire, std::uint8_t from, std::uint8_t to) {
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  TestBoard::Bytes all;
  for (const std::uint8_t byte : wire) {
    if (kz_receive(&receiver, byte, 0) != KZ_RECEIVE_FRAME) continue;
    if (receiver.body[0] == from) {
      receiver.body[0] = to;
    } else if (receiver.body[0] == to) {
      receiver.body[0] = from;
    }
    TestBoard::Bytes frame(KZ_FRAME_MAX);
    frame.resize(kz_frame_encode(receiver.body, receiver.length, frame.data()));
    all.insert(all.end(), frame.begin(), frame.end());
  }
  return all;
}

void move_to(TestBoard& board, std::uint8_t address) {
  board.to_board = [=](const TestBoard::Bytes& wire) { return readdressed(wire, address, 1); };
  board.to_host = [=](const TestBoard::Bytes& wire) { return readdressed(wire, 1, address); };
}

TEST(FindBoards, FindsTheBoardAtEachOfThe14Addresses) {
  for (std::uint8_t address = 1; address <= KZ_ADDRESS_LAST; ++address) {
    TestBoard board;
    move_to(board, address);
    const auto found = find_boards(board, board);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(*found, Addresses{address});
    EXPECT_LT(board.now(), std::chrono::milliseconds(700));
  }
}

TEST(FindBoards, FindsAllThatAreOnTheLine) {
  TestBoard board;
  // Two boards that do the same: one answers after the other.
  board.to_board = [](const TestBoard::Bytes& wire) {
    TestBoard::Bytes one = readdressed(wire, 14, 1);
    return wire == one ? readdressed(wire, 5, 1) : one;
  };
  int replies = 0;
  board.to_host = [&replies](const TestBoard::Bytes& wire) {
    return readdressed(wire, 1, ++replies == 1 ? 5 : 14);
  };
  EXPECT_EQ(find_boards(board, board).value(), (Addresses{5, 14}));
  EXPECT_EQ(addresses_text({5, 14}), "addresses 5 and 14");
  EXPECT_EQ(addresses_text({1, 5, 14}), "addresses 1, 5 and 14");
}

TEST(FindBoards, SilenceIsNoError) {
  TestBoard board;
  board.mute = true;
  EXPECT_EQ(find_boards(board, board).value(), Addresses{});
  board.link_failure = Error{Fault::environment, "port test-port was closed"};
  EXPECT_EQ(find_boards(board, board).error().message, "port test-port was closed");
}

TEST(FindBoards, ConnectNamesTheAddressAndTheOption) {
  TestBoard board;
  move_to(board, 3);
  const auto robot = Robot::connect(board, board);
  ASSERT_FALSE(robot);
  EXPECT_EQ(robot.error().fault, Fault::environment);
  EXPECT_EQ(robot.error().message,
            "no board answers at address 1 on test-port, but a board answers at address 3: give "
            "--address 3, or move that board with `kaz recover --robot serial:test-port`");
  EXPECT_TRUE(Robot::connect(board, board, {.address = 3}));
  const auto five = Robot::connect(board, board, {.address = 5});
  ASSERT_FALSE(five);
  EXPECT_NE(five.error().message.find(
                "move that board with `kaz recover --robot serial:test-port --address 5`"),
            std::string::npos)
      << five.error().message;
}

TEST(KeptBoard, SettingsInRamComeBack) {
  TestBoard board;
  const auto before = read_board(board, board, 1);
  ASSERT_TRUE(before) << before.error().message;
  {
    Robot robot = connect_to(board);
    ASSERT_TRUE(robot.set_gains(0x3ff, {.kp_per_rad = 7, .dead_band_rad = 0.01}));
    ASSERT_TRUE(robot.set_limits(0x7, {.ramp_rad_per_s = 2, .lower_rad = -0.1, .upper_rad = 0.2}));
    auto calibration = robot.calibration().value().joints;
    calibration[4].centre_rad += 0.02;
    ASSERT_TRUE(robot.set_calibration(1U << 4, calibration));
    ASSERT_TRUE(robot.enable(1));
  }
  EXPECT_NE(read_board(board, board, 1).value(), *before);
  const PutBack back = put_back(board, board, *before, {});
  EXPECT_EQ(back.left, std::vector<std::string>{});
  EXPECT_EQ(back.done,
            (std::vector<std::string>{"link watchdog", "gains of 10 joints", "limits of 3 joints",
                                      "calibration in use of l_elbow"}));
  EXPECT_EQ(read_board(board, board, 1).value(), *before);
  EXPECT_FALSE(board.motors_on());
  EXPECT_TRUE(put_back(board, board, *before, {}).done.empty());
}

TEST(KeptBoard, WhatCannotBePutBackIsNamed) {
  TestBoard board;
  const auto before = read_board(board, board, 1).value();
  board.link_failure = Error{Fault::environment, "port test-port was closed"};
  const PutBack back = put_back(board, board, before, {.flash = true});
  EXPECT_EQ(back.found_at, 0);
  ASSERT_EQ(back.left.size(), 1u);
  EXPECT_EQ(back.left[0],
            "everything, because the board was not found (port test-port was closed)");
  EXPECT_LT(board.now(), std::chrono::seconds(10));
}

}  // namespace
}  // namespace kaz::host
