// The bus as a whole: time on the wire, collisions, damage.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/virtual_bus.h"

#include <gtest/gtest.h>

#include <numeric>

#include "shared/base/random.hpp"
#include "sim/bus/bus_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using feetech::request;
using std::chrono::microseconds;
using std::chrono::milliseconds;

std::vector<int> ids_to(int last) {
  std::vector<int> ids(static_cast<std::size_t>(last));
  std::iota(ids.begin(), ids.end(), 1);
  return ids;
}

Packet sync_write(std::uint8_t address, const std::vector<int>& ids, const Bytes& data) {
  Bytes parameters{address, static_cast<std::uint8_t>(data.size())};
  for (const int id : ids) {
    parameters.push_back(static_cast<std::uint8_t>(id));
    parameters.insert(parameters.end(), data.begin(), data.end());
  }
  return request(feetech::kBroadcast, Instruction::sync_write, parameters);
}

Packet sync_read(std::uint8_t address, std::uint8_t length, const std::vector<int>& ids) {
  Bytes parameters{address, length};
  for (const int id : ids) parameters.push_back(static_cast<std::uint8_t>(id));
  return request(feetech::kBroadcast, Instruction::sync_read, parameters);
}

// Length of a cycle of a sync write and a sync read, from its first byte to the last one of the answers.
Time cycle_of(VirtualBus& bus, const std::vector<int>& ids, const Packet& write,
              const Packet& read) {
  const Time begin = bus.time();
  bus.write(feetech::wire_of(write));
  BusHost host(bus);
  EXPECT_EQ(host.send(read, milliseconds(100)).size(), ids.size());
  return host.last_byte() - begin;
}

// Twelve servos; times of the wire alone, computed apart from this code (docs/reference/servo-bus.md).
TEST(Timing, OfTwelveServosIsThatOfTheWire) {
  const auto ids = ids_to(12);
  struct Case {
    long baud;
    int code;
    double goals_ms, block_ms;  // write 2 and read 2 bytes; write 7 and read 15
  };
  for (const Case& c : {Case{1000000, 0, 1.60, 3.76}, Case{57600, 6, 27.78, 65.28}}) {
    const auto bus = bus_of(ids);
    for (std::size_t i = 0; i < 12; ++i) bus->servo(i).registers().set("baud_rate", c.code);
    bus->set_power(true);
    bus->set_host_baud(c.baud);
    const double goals =
        1e3 * seconds(cycle_of(*bus, ids, sync_write(42, ids, {0, 8}), sync_read(56, 2, ids)));
    EXPECT_NEAR(goals, c.goals_ms, 0.02 * c.goals_ms);
    const double block = 1e3 * seconds(cycle_of(*bus, ids, sync_write(41, ids, Bytes(7, 1)),
                                                sync_read(56, 15, ids)));
    EXPECT_NEAR(block, c.block_ms, 0.02 * c.block_ms);
  }
}

TEST(Timing, ReturnDelaysAddUp) {
  const auto ids = ids_to(12);
  const auto bus = bus_of(ids);
  for (std::size_t i = 0; i < 12; ++i) bus->servo(i).registers().set("return_delay", 250);
  const double ms =
      1e3 * seconds(cycle_of(*bus, ids, sync_write(42, ids, {0, 8}), sync_read(56, 2, ids)));
  EXPECT_NEAR(ms, 1.60 + 12 * 0.5, 0.02 * 7.6);
}

TEST(Timing, DoesNotDependOnHowTheBusIsAdvanced) {
  const auto ids = ids_to(3);
  const auto whole = bus_of(ids), pieces = bus_of(ids);
  const Bytes wire = feetech::wire_of(sync_read(56, 8, ids));
  whole->write(wire);
  pieces->write(wire);
  whole->advance(milliseconds(5));
  for (Time at(0); at < milliseconds(5); at += Time(3333)) pieces->advance(at);
  pieces->advance(milliseconds(5));
  ASSERT_EQ(whole->received().size(), 3u * 14);
  ASSERT_EQ(pieces->received().size(), whole->received().size());
  for (std::size_t i = 0; i < whole->received().size(); ++i) {
    EXPECT_EQ(whole->received()[i].byte, pieces->received()[i].byte);
    EXPECT_EQ(whole->received()[i].at, pieces->received()[i].at);
  }
}

TEST(SyncRead, IsAnsweredInTheOrderOfTheListAndStopsAtWhoIsMissing) {
  const auto bus = bus_of({1, 2, 3, 4});
  BusHost host(*bus);
  const auto ids = [](const std::vector<Packet>& answers) {
    std::vector<int> found;
    for (const Packet& answer : answers) found.push_back(answer.id);
    return found;
  };
  EXPECT_EQ(ids(host.send(sync_read(56, 2, {3, 1, 4, 2}))), (std::vector<int>{3, 1, 4, 2}));
  EXPECT_EQ(ids(host.send(sync_read(56, 2, {2, 1}))), (std::vector<int>{2, 1}));
  EXPECT_EQ(ids(host.send(sync_read(56, 2, {1, 9, 3, 4}))), (std::vector<int>{1}));
  // Who waited in vain answers the next request as ever.
  EXPECT_EQ(ids(host.send(sync_read(56, 2, {3, 4}))), (std::vector<int>{3, 4}));
}

// Both answer at once. Where their bytes are equal nobody notices; their positions differ, and so does what
// arrives from both.
TEST(DuplicateId, CollidesOnTheWire) {
  const auto bus = bus_of({1, 1});
  auto& world = static_cast<ShaftWorld&>(bus->world());
  world.joints_[0].angle = 0.5;
  world.joints_[1].angle = -0.7;
  bus->advance(milliseconds(3));
  BusHost host(*bus);
  EXPECT_EQ(host.send(request(1, Instruction::ping)).size(), 1u) << "equal answers";
  EXPECT_FALSE(host.read(1, 56, 2));
  EXPECT_EQ(host.counts().bad_checksums, 1u);
  // With another return delay bytes are shifted against each other.
  bus->servo(1).registers().set("return_delay", 2);
  EXPECT_FALSE(host.read(1, 56, 2));
  // Alone it is heard.
  bus->servo(1).registers().set("id", 2);
  bus->servo(1).registers().set("return_delay", 0);
  EXPECT_TRUE(host.read(1, 56, 2));
}

TEST(BroadcastPing, OfSeveralServosCollides) {
  const auto one = bus_of({5}), several = bus_of({5, 6, 9});
  BusHost host(*one), other(*several);
  EXPECT_EQ(host.send(request(feetech::kBroadcast, Instruction::ping)).size(), 1u);
  EXPECT_TRUE(other.send(request(feetech::kBroadcast, Instruction::ping)).empty());
}

// One byte in 1,000 damaged, both ways. Whatever a servo did not execute left a trace: in the counts of the
// servo, and for the host, an answer that did not come. Nothing that came was wrong.
TEST(Damage, LosesNoCommandSilently) {
  const auto bus = bus_of({1, 2});
  bus->line().set_damage(0.001, 7);
  BusHost host(*bus);
  Random random(11);
  int lost = 0, unanswered = 0, wrong = 0;
  constexpr int kCommands = 20000;
  for (int i = 0; i < kCommands; ++i) {
    const int id = 1 + i % 2;
    const auto goal = static_cast<int>(random.below(4096));
    VirtualServo& servo = bus->servo(static_cast<std::size_t>(i % 2));
    const auto executed = servo.executed();
    const auto noticed =
        servo.counts().bad() + servo.counts().skipped_bytes + servo.framing_errors();
    const bool answered = host.set(id, "goal_position", goal);
    unanswered += answered ? 0 : 1;
    // 110 ms of silence end what a damaged length byte began.
    if (!answered) bus->advance(bus->time() + milliseconds(110));
    if (servo.executed() != executed) {
      wrong += servo.registers().get("goal_position") != goal ? 1 : 0;
      continue;
    }
    ++lost;
    EXPECT_FALSE(answered) << "the host believes a command that was lost";
    // What a packet lacks at its end is noticed with the next byte.
    (void)host.send(request(7, Instruction::ping));
    const auto after = servo.counts().bad() + servo.counts().skipped_bytes + servo.framing_errors();
    const bool elsewhere = bus->servo(static_cast<std::size_t>(1 - i % 2)).executed() > 0;
    EXPECT_TRUE(after > noticed || elsewhere) << i;
  }
  // 9 bytes of request: some 0.9 % of 20,000; with the answer's 6, 1.5 %.
  EXPECT_NEAR(lost, 180, 50);
  EXPECT_NEAR(unanswered, 300, 60);
  EXPECT_EQ(wrong, 0);
}

TEST(Host, AtAnotherRateGetsNoAnswer) {
  const auto bus = bus_of({1});
  bus->set_host_baud(115200);
  BusHost host(*bus);
  EXPECT_TRUE(host.send(request(1, Instruction::ping), milliseconds(20)).empty());
  const auto& counts = bus->servo(0).counts();
  EXPECT_GT(counts.skipped_bytes + counts.bad() + bus->servo(0).framing_errors(), 0u);
}

TEST(VirtualBus, NeedsAServoForEachJoint) {
  servo_bus::BusFile file;
  file.servos.push_back({"joint1", 1, servo_bus::find_model("sts3215"), 2048, false});
  const auto missing = VirtualBus::create(std::make_unique<ShaftWorld>(2), file);
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("joint2"), std::string::npos);
  file.servos[0].joint = "elbow";
  const auto unknown = VirtualBus::create(std::make_unique<ShaftWorld>(1), file);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("elbow"), std::string::npos);
}

}  // namespace
}  // namespace kaz::sim
