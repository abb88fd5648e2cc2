// The bus as a whole: time on the wire, collisions, damage.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/virtual_bus.h"

#include <gtest/gtest.h>

#include <array>
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

// Also at the lowest rate, and in the time that Feetech's SDK waits for it.
TEST(BroadcastPing, IsAnsweredInTheOrderOfTheIdsIfTheFileSaysSo) {
  for (const long baud : {1000000L, 38400L}) {
    const auto bus = bus_of({9, 5, 6, 253}, "sts3215", [&](servo_bus::BusFile& file) {
      file.baud = baud;
      file.broadcast_ping_in_turn = true;
    });
    bus->set_host_baud(baud);
    BusHost host(*bus);
    const auto answers =
        host.send(request(feetech::kBroadcast, Instruction::ping), milliseconds(760));
    ASSERT_EQ(answers.size(), 4u) << baud;
    for (const std::size_t i : {0u, 1u, 2u, 3u})
      EXPECT_EQ(answers[i].id, (std::array{5, 6, 9, 253}[i]));
    // A ping of one servo is answered at once.
    EXPECT_EQ(host.send(request(253, Instruction::ping), milliseconds(5)).size(), 1u);
  }
}

// A Koch arm: XL430 at 12 V and XL330 at 5 V on one bus.
TEST(Supply, OfAServoIsItsOwn) {
  const auto bus = bus_of({1, 2, 3}, "xl430-w250", [](servo_bus::BusFile& file) {
    file.supply_volts = 12;
    file.supply_ohm = 0.5;
    for (const std::size_t i : {1u, 2u}) {
      file.servos[i].model = servo_bus::find_model("xl330-m288");
      file.servos[i].supply_volts = 5;
    }
  });
  auto& world = static_cast<ShaftWorld&>(bus->world());
  DynamixelHost host(*bus);
  bus->advance(milliseconds(500));
  for (const auto& [id, volts] : {std::pair{1, 120}, {2, 50}, {3, 50}}) {
    EXPECT_EQ(host.get(id, "present_input_voltage"), volts) << id;
    EXPECT_EQ(host.get(id, "hardware_error_status"), 0) << id;
  }
  EXPECT_FALSE(world.drives_[0].supply_volts);
  EXPECT_EQ(world.drives_[1].supply_volts, 5.0);
  // The current of servo 2 pulls down what servo 3 shares with it, and no other supply.
  ASSERT_TRUE(host.set(2, "operating_mode", 16));
  ASSERT_TRUE(host.set(2, "torque_enable", 1));
  ASSERT_TRUE(host.set(2, "goal_pwm", 885));
  world.joints_[1].current = 2;
  bus->advance(bus->time() + milliseconds(100));
  EXPECT_EQ(host.get(1, "present_input_voltage"), 120);
  EXPECT_EQ(host.get(3, "present_input_voltage"), 40);
  EXPECT_NEAR(bus->volts(), 12, 1e-9);
  EXPECT_NEAR(bus->volts(2), 4, 1e-9);
  bus->set_supply_volts(11);
  bus->advance(bus->time() + milliseconds(10));
  EXPECT_EQ(host.get(1, "present_input_voltage"), 110);
  EXPECT_EQ(host.get(3, "present_input_voltage"), 40);
}

TEST(Adapter, HoldsBytesUntilItsTimerEnds) {
  const auto bus = bus_of({1});
  bus->set_adapter_latency(milliseconds(16));
  bus->advance(milliseconds(3));
  bus->write(feetech::wire_of(request(1, Instruction::ping)));
  bus->advance(Time(15'900'000));
  EXPECT_TRUE(bus->received().empty());
  bus->advance(milliseconds(17));
  ASSERT_EQ(bus->received().size(), 6u);
  EXPECT_EQ(bus->received().back().at, milliseconds(16));
  bus->received().clear();
  // A full packet does not wait: 62 of 84 bytes.
  bus->write(feetech::wire_of(request(1, Instruction::read, {0, 78})));
  bus->advance(bus->time() + milliseconds(3));
  EXPECT_EQ(bus->received().size(), VirtualBus::kAdapterPacket);
  bus->advance(milliseconds(33));
  EXPECT_EQ(bus->received().size(), 84u);
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
