// CanLink above its sockets, which are pairs of SOCK_SEQPACKET here: one message per read, as CAN's are.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/can_link.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <utility>
#include <vector>

#include "host/link/can_sockets_testing.h"
#include "host/link/wall_clock.h"
#include "shared/protocol/frame.h"

namespace kaz::host {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

using Bus = TestBus;

std::unique_ptr<CanLink> open_link(Bus& bus, const CanLink::Options& options = {}) {
  auto link = CanLink::open(std::make_unique<TestCanSockets>(bus), options);
  EXPECT_TRUE(link) << link.error().message;
  return std::move(*link);
}

Bytes frame_of(const Bytes& body) {
  Bytes wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}
Bytes inside(const Bytes& frame) {
  return {frame.begin() + 1, frame.end() - 1};
}
Bytes read_all(PortLink& link) {
  Bytes all;
  while (true) {
    std::array<std::uint8_t, 7> some;  // less than a frame
    const auto count = link.read(some, WallClock().now());
    EXPECT_TRUE(count) << count.error().message;
    if (!count || *count == 0) return all;
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(*count));
  }
}

TEST(CanLink, AFrameIsAMessageOnItsAddressIdentifier) {
  Bus bus;
  const auto link = open_link(bus);
  EXPECT_EQ(link->name(), "can:can7");
  const Bytes one = frame_of({1, KZ_TYPE_state, 7}), fourteen = frame_of({14, KZ_TYPE_state, 8});
  Bytes wire = one;
  wire.insert(wire.end(), fourteen.begin(), fourteen.end());
  ASSERT_TRUE(link->write(wire));
  EXPECT_EQ(bus.received(0x6A1), inside(one));
  EXPECT_EQ(bus.received(0x6AE), inside(fourteen));
  EXPECT_EQ(bus.opened[0x6A1].rx_id, 0x6B1u);
  EXPECT_EQ(bus.opened.size(), 2u) << "only what is written to is opened";

  ASSERT_TRUE(bus.deliver(0x6A1, inside(one)));
  EXPECT_EQ(read_all(*link), one);
  EXPECT_EQ(link->counts(), "");
}

TEST(CanLink, BytesInPiecesAreOneMessage) {
  Bus bus;
  const auto link = open_link(bus);
  const Bytes frame = frame_of({3, KZ_TYPE_health, 1});
  for (const std::uint8_t byte : frame) ASSERT_TRUE(link->write({&byte, 1}));
  EXPECT_EQ(bus.received(0x6A3), inside(frame));
  EXPECT_TRUE(bus.received(0x6A3).empty());
}

TEST(CanLink, BroadcastAndWhatHasNoAddressGoesToAll) {
  Bus bus;
  const auto link = open_link(bus);
  const Bytes all = frame_of({KZ_ADDRESS_ALL, KZ_TYPE_stop, 1});
  ASSERT_TRUE(link->write(all));
  EXPECT_EQ(bus.received(0x6AF), inside(all));
  EXPECT_EQ(bus.opened[0x6AF].mode, IsoTpChannel::Mode::broadcast);
  for (const Bytes& strange : {frame_of({0, 1, 1}), frame_of({200, 1, 1}), Bytes{0, 5, 0}}) {
    ASSERT_TRUE(link->write(strange));
    EXPECT_EQ(bus.received(0x6AF), inside(strange));
  }
}

TEST(CanLink, EndlessBytesAreDroppedAndTheNextFramePasses) {
  Bus bus;
  const auto link = open_link(bus);
  ASSERT_TRUE(link->write(Bytes(100000, 0x55)));
  const Bytes frame = frame_of({1, KZ_TYPE_state, 1});
  ASSERT_TRUE(link->write(frame));
  EXPECT_EQ(bus.received(0x6A1), inside(frame));
  EXPECT_EQ(link->statistics().discarded, 1u);
}

TEST(CanLink, TheBoardsEndHearsItsAddressesAndBroadcast) {
  Bus bus;
  const auto link = open_link(bus, {.end = CanLink::End::board, .addresses = {2, 5}});
  EXPECT_EQ(bus.opened.size(), 3u);
  EXPECT_EQ(bus.opened[0x6B2].rx_id, 0x6A2u);
  EXPECT_EQ(bus.opened[0x6BF].rx_id, 0x6AFu);
  EXPECT_EQ(bus.opened[0x6BF].mode, IsoTpChannel::Mode::listen);
  const Bytes stop = frame_of({KZ_ADDRESS_ALL, KZ_TYPE_stop, 1});
  ASSERT_TRUE(bus.deliver(0x6BF, inside(stop)));
  EXPECT_EQ(read_all(*link), stop);

  const Bytes reply = frame_of({5, KZ_TYPE_stop_reply, 1}), foreign = frame_of({9, 1, 1});
  ASSERT_TRUE(link->write(reply));
  EXPECT_EQ(bus.received(0x6B5), inside(reply));
  ASSERT_TRUE(link->write(foreign));
  EXPECT_EQ(bus.received(0x6B2), inside(foreign)) << "what says no address of its own";
}

TEST(CanLink, ErrorFramesAreCounted) {
  Bus bus;
  const auto link = open_link(bus);
  ASSERT_TRUE(bus.error_frame(CAN_ERR_ACK));
  ASSERT_TRUE(bus.error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW));
  ASSERT_TRUE(
      bus.error_frame(CAN_ERR_BUSOFF | CAN_ERR_RESTARTED));  // over again before anybody looked
  EXPECT_TRUE(read_all(*link).empty());
  EXPECT_EQ(link->statistics().error_frames, 3u);
  EXPECT_EQ(link->counts(), "3 error frames, bus-off 1 time, 1 restart, 1 controller overflow");
}

TEST(CanLink, BusOffIsALostLinkUntilTheInterfaceRunsAgain) {
  Bus bus;
  const auto link = open_link(bus);
  const Bytes frame = frame_of({1, KZ_TYPE_state, 1});
  ASSERT_TRUE(link->write(frame));
  ASSERT_TRUE(bus.error_frame(CAN_ERR_BUSOFF));
  bus.state = Error{Fault::environment, "can7 is bus-off"};
  std::array<std::uint8_t, 8> some;
  const auto lost = link->read(some, WallClock().now());
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().message, "can7 is bus-off");
  EXPECT_FALSE(link->write(frame));
  EXPECT_FALSE(link->read(some, WallClock().now()));
  EXPECT_FALSE(link->reopen());
  bus.state.reset();
  ASSERT_TRUE(link->reopen());
  ASSERT_TRUE(link->write(frame));
  EXPECT_EQ(bus.received(0x6A1), inside(frame));
  ASSERT_TRUE(bus.deliver(0x6A1, inside(frame)));
  EXPECT_EQ(read_all(*link), frame);
}

TEST(CanLink, AnInterfaceThatGoesDownIsALostLink) {
  Bus bus;
  const auto link = open_link(bus);
  ASSERT_TRUE(link->write(frame_of({1, KZ_TYPE_state, 1})));
  bus.state = Error{Fault::environment, "can7 is down"};
  bus.errors = Descriptor();
  std::array<std::uint8_t, 8> some;
  const auto lost = link->read(some, WallClock().now());
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().fault, Fault::environment);
  EXPECT_EQ(lost.error().message, "can7 is down");
}

// A receiver that takes nothing, as one that sends no flow control.
TEST(CanLink, AMessageThatNobodyTakesIsGivenUpAndTheNextOneIsSent) {
  Bus bus;
  const auto link = open_link(bus);
  const Bytes frame = frame_of({1, KZ_TYPE_state, 1});
  const WallClock clock;
  for (int i = 0; i < 3000 && link->statistics().unfinished_out == 0; ++i) {
    ASSERT_TRUE(link->write(frame));
    if (link->has_unsent()) {
      std::array<std::uint8_t, 8> some;
      ASSERT_TRUE(link->read(some, clock.now() + 50ms));
    }
  }
  EXPECT_EQ(link->statistics().unfinished_out, 1u);
  EXPECT_FALSE(link->has_unsent());
  ASSERT_TRUE(link->write(frame));
  EXPECT_EQ(bus.received(0x6A1), inside(frame)) << "on a new socket";
}

TEST(CanLink, HasNoModemLines) {
  Bus bus;
  const auto lines = open_link(bus)->set_dtr_rts(true, true);
  ASSERT_FALSE(lines);
  EXPECT_EQ(lines.error().message, "can:can7 is a CAN bus, which has no lines DTR and RTS");
}

TEST(CanSockets, AnInterfaceThatIsNotThereIsASentence) {
  const auto link = CanLink::open(kernel_can_sockets("kaz-none"), {});
  ASSERT_FALSE(link);
  EXPECT_EQ(link.error().fault, Fault::environment);
  EXPECT_EQ(link.error().message.find("no such CAN interface: kaz-none ("), 0u)
      << link.error().message;
  const auto wrong = CanLink::open(kernel_can_sockets("lo"), {});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message.find("lo is a network interface, but not a CAN interface ("), 0u)
      << wrong.error().message;
}

}  // namespace
}  // namespace kaz::host
