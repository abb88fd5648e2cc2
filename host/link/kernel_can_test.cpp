// CanLink on the kernel's sockets: on the CAN interface that the environment names, KAZ_TEST_CAN=vcan0, which
// it takes down and up, so as root. It is run by guest.links, in a virtual machine (tests/system/guest).
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/tty.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/can_link.h"
#include "host/link/wall_clock.h"
#include "shared/protocol/frame.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr const char* kNoInterface =
    "KAZ_TEST_CAN names no CAN interface, as KAZ_TEST_CAN=vcan0 does; ./tools/dev study guest has "
    "some";

void set_up(const std::string& interface, bool up) {
  const Descriptor any(socket(AF_INET, SOCK_DGRAM, 0));
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  ASSERT_EQ(ioctl(any.get(), SIOCGIFFLAGS, &request), 0);
  request.ifr_flags =
      static_cast<short>(up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP);
  ASSERT_EQ(ioctl(any.get(), SIOCSIFFLAGS, &request), 0) << "needs root";
}

struct KernelCan : ::testing::Test {
  void SetUp() override {
    const char* name = std::getenv("KAZ_TEST_CAN");
    ASSERT_NE(name, nullptr) << kNoInterface;
    interface = name;
    auto at_host = CanLink::open(kernel_can_sockets(interface), {});
    ASSERT_TRUE(at_host) << at_host.error().message;
    host = std::move(*at_host);
    auto at_board = CanLink::open(kernel_can_sockets(interface),
                                  {.end = CanLink::End::board, .addresses = {1, 2}});
    ASSERT_TRUE(at_board) << at_board.error().message;
    board = std::move(*at_board);
  }
  void inject(std::uint32_t classes) {
    const Descriptor raw(socket(PF_CAN, SOCK_RAW, CAN_RAW));
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
    ASSERT_EQ(bind(raw.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    can_frame frame{};
    frame.can_id = CAN_ERR_FLAG | classes;
    frame.can_dlc = CAN_ERR_DLC;
    ASSERT_EQ(send(raw.get(), &frame, sizeof frame, 0), static_cast<ssize_t>(sizeof frame));
  }
  static Bytes frame_of(std::uint8_t address, std::size_t fields) {
    Bytes body{address, KZ_TYPE_targets, 7};
    for (std::size_t i = 0; i < fields; ++i) body.push_back(static_cast<std::uint8_t>(31 * i));
    Bytes wire(KZ_FRAME_MAX);
    wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
    return wire;
  }
  static Bytes read_one(CanLink& link, std::size_t count) {
    Bytes all;
    const Time until = WallClock().now() + 2s;
    while (all.size() < count && WallClock().now() < until) {
      std::array<std::uint8_t, 256> some;
      const auto n = link.read(some, until);
      if (!n) return all;
      all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(*n));
    }
    return all;
  }
  // `from` is read too: its flow control needs nobody, but what waits for a transfer to end does.
  static void expect_passes(CanLink& from, CanLink& to, const Bytes& frame) {
    const auto written = from.write(frame);
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_EQ(read_one(to, frame.size()), frame) << frame.size();
  }
  std::string interface;
  std::unique_ptr<CanLink> host, board;
};

TEST_F(KernelCan, FramesOfAllLengthsPassBothWays) {
  for (std::size_t fields = 0; fields <= KZ_PAYLOAD_MAX; fields += 5) {
    expect_passes(*host, *board, frame_of(1, fields));
    expect_passes(*board, *host, frame_of(1, fields));
    expect_passes(*host, *board, frame_of(2, fields));
  }
  EXPECT_EQ(host->counts(), "");
  EXPECT_EQ(board->counts(), "");
}

TEST_F(KernelCan, BroadcastOfAllLengthsNeedsNoFlowControl) {
  for (const std::size_t fields : {0, 1, 10, 50, 96})
    expect_passes(*host, *board, frame_of(KZ_ADDRESS_ALL, fields));
}

TEST_F(KernelCan, AnAddressWithoutABoardDoesNotDisturbTheOthers) {
  ASSERT_TRUE(host->write(frame_of(9, 50)));
  expect_passes(*host, *board, frame_of(1, 50));
  std::array<std::uint8_t, 8> some;
  ASSERT_TRUE(host->write(frame_of(9, 50)));
  ASSERT_TRUE(host->read(some, WallClock().now() + 400ms));
  EXPECT_GE(host->statistics().unfinished_out, 1u);
  expect_passes(*host, *board, frame_of(1, 50));
}

TEST_F(KernelCan, ASecondProgramIsRefused) {
  expect_passes(*host, *board, frame_of(1, 5));
  auto second = CanLink::open(kernel_can_sockets(interface), {});
  ASSERT_TRUE(second);
  const auto written = (*second)->write(frame_of(1, 5));
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("is in use: another program sends frames with the id"),
            std::string::npos);
}

TEST_F(KernelCan, InjectedErrorFramesAreCountedAndBusOffIsALostLink) {
  inject(CAN_ERR_ACK);
  inject(CAN_ERR_CRTL);
  std::array<std::uint8_t, 8> some;
  ASSERT_TRUE(host->read(some, WallClock().now() + 50ms));
  EXPECT_EQ(host->statistics().error_frames, 2u);
  inject(CAN_ERR_BUSOFF);
  const auto lost = host->read(some, WallClock().now() + 2s);
  ASSERT_FALSE(lost);
  EXPECT_NE(lost.error().message.find("bus-off"), std::string::npos) << lost.error().message;
  ASSERT_TRUE(host->reopen());
  ASSERT_TRUE(board->reopen());
  expect_passes(*host, *board, frame_of(1, 50));
}

TEST_F(KernelCan, DownAndUpTwentyTimes) {
  std::array<std::uint8_t, 8> some;
  for (int i = 0; i < 20; ++i) {
    set_up(interface, false);
    for (CanLink* link : {host.get(), board.get()}) {
      const auto lost = link->read(some, WallClock().now() + 2s);
      ASSERT_FALSE(lost);
      EXPECT_NE(lost.error().message.find("is down"), std::string::npos) << lost.error().message;
      EXPECT_FALSE(link->write(frame_of(1, 5)));
      EXPECT_FALSE(link->reopen());
    }
    set_up(interface, true);
    ASSERT_TRUE(host->reopen());
    ASSERT_TRUE(board->reopen());
    expect_passes(*host, *board, frame_of(1, 50));
    expect_passes(*board, *host, frame_of(1, 50));
  }
}

// A driver's own bus-off, as an adapter that talks text (slcan) reports it; the adapter is a pty.
TEST(KernelCanAdapter, IsReportedWhileItIsBusOffAndNotWhenItIsSetUpAgain) {
  ASSERT_NE(std::getenv("KAZ_TEST_CAN"), nullptr) << kNoInterface;
  const Descriptor adapter(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  ASSERT_EQ(grantpt(adapter.get()), 0);
  ASSERT_EQ(unlockpt(adapter.get()), 0);
  const Descriptor line(open(ptsname(adapter.get()), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  tcgetattr(line.get(), &settings);
  cfmakeraw(&settings);
  tcsetattr(line.get(), TCSANOW, &settings);
  const int discipline = N_SLCAN;
  ASSERT_EQ(ioctl(line.get(), TIOCSETD, &discipline), 0) << "needs the module slcan";
  std::array<char, IFNAMSIZ> name{};
  ASSERT_EQ(ioctl(line.get(), SIOCGIFNAME, name.data()), 0);
  const auto sockets = kernel_can_sockets(name.data());
  const auto says = [&](const std::string& words) {
    const auto checked = sockets->check();
    return !checked && checked.error().message.find(words) != std::string::npos;
  };
  EXPECT_TRUE(says("is down"));
  for (int i = 0; i < 5; ++i) {
    set_up(name.data(), true);
    ASSERT_TRUE(sockets->check()) << sockets->check().error().message << ": just set up, round "
                                  << i;
    // State bus-off, 255 errors each of receiving and sending.
    const std::string_view bus_off = "sb255255\r";
    ASSERT_EQ(write(adapter.get(), bus_off.data(), bus_off.size()),
              static_cast<ssize_t>(bus_off.size()));
    for (const Time until = WallClock().now() + 2s; !says("is bus-off");) {
      ASSERT_LT(WallClock().now(), until) << "the driver's bus-off is not noticed";
      ASSERT_TRUE(WallClock().sleep_until(WallClock().now() + 5ms));
    }
    set_up(name.data(), false);
    EXPECT_TRUE(says("is down"));
  }
}

}  // namespace
}  // namespace kaz::host
