// The protocol of a virtual servo: the manuals' examples, answers and silence, memory.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/feetech_servo.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim/bus/bus_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using feetech::request;

Bytes bytes_of(const std::string& hex) {
  std::istringstream words(hex);
  Bytes bytes;
  for (unsigned byte; words >> std::hex >> byte;) bytes.push_back(static_cast<std::uint8_t>(byte));
  return bytes;
}

// Without control loops and world: registers keep what the example sets.
TEST(ManualExample, IsAnsweredByteForByte) {
  std::ifstream file("shared/feetech/corpus/packets.json");
  int played = 0;
  for (const auto& example : nlohmann::json::parse(file)) {
    if (!example.contains("servos"))
      continue;  // of registers or instructions that no servo here has
    SCOPED_TRACE(example.at("name").get<std::string>());
    ++played;
    std::vector<FeetechServo> servos;
    for (const auto& [id, registers] : example.at("servos").items()) {
      FeetechServo& servo = servos.emplace_back(*servo_bus::find_model("sts3215"), std::stoi(id));
      for (const auto& [name, value] : registers.items())
        servo.registers().set(name, value.get<int>());
    }
    std::vector<Bytes> answers;
    std::vector<std::pair<Bytes, std::size_t>> wire{
        {bytes_of(example.at("request")), servos.size()}};
    // What one sends, all others hear, in turn.
    for (std::size_t next = 0; next < wire.size(); ++next) {
      const auto [bytes, sender] = wire[next];
      if (sender != servos.size()) answers.push_back(bytes);
      for (std::size_t i = 0; i < servos.size(); ++i) {
        for (const std::uint8_t byte : bytes) {
          if (i == sender) break;
          if (const auto answer = servos[i].take(byte, Time(0))) wire.push_back({answer->bytes, i});
        }
      }
    }
    std::vector<Bytes> expected;
    for (const std::string text : example.at("answers")) expected.push_back(bytes_of(text));
    EXPECT_EQ(answers, expected);
    if (!example.contains("after")) continue;
    for (FeetechServo& servo : servos) {
      for (const auto& [name, value] : example.at("after").items())
        EXPECT_EQ(servo.registers().get(name), value.get<int>()) << name;
    }
  }
  EXPECT_EQ(played, 17);
}

TEST(FeetechServo, RegWriteWaitsForAction) {
  const auto bus = bus_of({1, 2});
  BusHost host(*bus);
  for (const int id : {1, 2}) {
    EXPECT_EQ(host.send(request(static_cast<std::uint8_t>(id), Instruction::reg_write, {42, 0, 4}))
                  .size(),
              1u);
    EXPECT_EQ(host.get(id, "goal_position"), 0);
    EXPECT_EQ(host.get(id, "async_write"), 1);
  }
  EXPECT_TRUE(host.send(request(feetech::kBroadcast, Instruction::action)).empty());
  for (const int id : {1, 2}) {
    EXPECT_EQ(host.get(id, "goal_position"), 1024);
    EXPECT_EQ(host.get(id, "async_write"), 0);
  }
}

TEST(FeetechServo, AtResponseLevelZeroOnlyPingAndReadsAreAnswered) {
  const auto bus = bus_of({1});
  BusHost host(*bus);
  EXPECT_TRUE(host.set(1, "response_level", 0)) << "the write itself is of level 1";
  EXPECT_FALSE(host.set(1, "goal_position", 100));
  EXPECT_TRUE(host.send(request(1, Instruction::reg_write, {42, 0, 4})).empty());
  EXPECT_TRUE(host.send(request(1, Instruction::action)).empty());
  EXPECT_EQ(host.send(request(1, Instruction::ping)).size(), 1u);
  EXPECT_EQ(host.get(1, "goal_position"), 1024);
  EXPECT_EQ(host.send(request(feetech::kBroadcast, Instruction::sync_read, {56, 2, 1})).size(), 1u);
}

TEST(FeetechServo, IsSilentToOthersRequestsAndToWhatIsNoRequest) {
  const auto bus = bus_of({1});
  BusHost host(*bus);
  EXPECT_TRUE(host.send(request(2, Instruction::ping)).empty());
  EXPECT_TRUE(host.send(request(feetech::kBroadcast, Instruction::read, {56, 2})).empty());
  EXPECT_TRUE(host.send(Packet{1, 0x55, {}}).empty());
  EXPECT_TRUE(host.send(request(1, Instruction::read, {56})).empty());
  EXPECT_TRUE(host.send(request(1, Instruction::write, {42})).empty());
  EXPECT_TRUE(host.send(request(feetech::kBroadcast, Instruction::sync_read, {56, 2, 7})).empty());
  Bytes wrong = feetech::wire_of(request(1, Instruction::ping));
  wrong.back() ^= 1;
  EXPECT_TRUE(host.send(wrong).empty());
  EXPECT_EQ(bus->servo(0).counts().bad_checksums, 1u);
  EXPECT_EQ(host.send(request(1, Instruction::ping)).size(), 1u);
}

TEST(FeetechServo, AnswersAChangeOfItsIdWithTheOldOne) {
  const auto bus = bus_of({1});
  BusHost host(*bus);
  EXPECT_TRUE(host.set(1, "id", 9));
  EXPECT_TRUE(host.send(request(1, Instruction::ping)).empty());
  EXPECT_EQ(host.send(request(9, Instruction::ping)).size(), 1u);
}

TEST(FeetechServo, AnswersAChangeOfItsRateAtTheOldOne) {
  const auto bus = bus_of({1});
  BusHost host(*bus);
  EXPECT_TRUE(host.set(1, "baud_rate", 4));
  EXPECT_TRUE(host.send(request(1, Instruction::ping)).empty());
  bus->set_host_baud(115200);
  EXPECT_EQ(host.send(request(1, Instruction::ping)).size(), 1u);
}

TEST(FeetechServo, KeepsEepromWhileUnlockedAndLosesRam) {
  const auto bus = bus_of({1});
  BusHost host(*bus);
  EXPECT_TRUE(host.set(1, "position_p", 16));
  EXPECT_EQ(host.get(1, "position_p"), 16) << "takes effect, locked or not";
  bus->set_power(false);
  EXPECT_TRUE(host.send(request(1, Instruction::ping)).empty());
  bus->set_power(true);
  EXPECT_EQ(host.get(1, "position_p"), 32);
  EXPECT_TRUE(host.set(1, "lock", 0));
  EXPECT_TRUE(host.set(1, "position_p", 16));
  EXPECT_TRUE(host.set(1, "acceleration", 50));
  EXPECT_TRUE(host.set(1, "max_torque", 300));
  bus->set_power(false);
  bus->set_power(true);
  EXPECT_EQ(host.get(1, "position_p"), 16);
  EXPECT_EQ(host.get(1, "acceleration"), 0);
  EXPECT_EQ(host.get(1, "lock"), 1);
  EXPECT_EQ(host.get(1, "torque_limit"), 300) << "copied at power-on";
}

TEST(FeetechServo, RestartIsNotAnsweredAndTakesItsTime) {
  const auto bus = bus_of({1});
  BusHost host(*bus);
  EXPECT_TRUE(host.set(1, "acceleration", 50));
  EXPECT_TRUE(host.send(request(1, Instruction::restart)).empty());
  bus->advance(bus->time() + std::chrono::milliseconds(700));
  EXPECT_TRUE(host.send(request(1, Instruction::ping)).empty());
  bus->advance(bus->time() + std::chrono::milliseconds(100));
  EXPECT_EQ(host.send(request(1, Instruction::ping)).size(), 1u);
  EXPECT_EQ(host.get(1, "acceleration"), 0);
}

TEST(FeetechServo, BackupAndRestoreNeedTheLockOpen) {
  const auto bus = bus_of({3});
  BusHost host(*bus);
  EXPECT_TRUE(host.set(3, "position_p", 16));
  EXPECT_EQ(host.send(request(3, Instruction::backup)).size(), 1u) << "locked: nothing kept";
  EXPECT_TRUE(host.set(3, "position_p", 99));
  EXPECT_TRUE(host.set(3, "lock", 0));
  EXPECT_EQ(host.send(request(3, Instruction::restore)).size(), 1u);
  EXPECT_EQ(host.get(3, "position_p"), 32) << "as from the factory";
  EXPECT_EQ(host.get(3, "id"), 3) << "all but the id";
  EXPECT_TRUE(host.set(3, "position_p", 20));
  EXPECT_EQ(host.send(request(3, Instruction::backup)).size(), 1u);
  EXPECT_TRUE(host.set(3, "position_p", 99));
  EXPECT_EQ(host.send(request(3, Instruction::restore)).size(), 1u);
  EXPECT_EQ(host.get(3, "position_p"), 20);
}

TEST(FeetechServo, BytesTooFarApartAreNoPacket) {
  const auto bus = bus_of({1});
  BusHost host(*bus);
  const Bytes ping = feetech::wire_of(request(1, Instruction::ping));
  for (const auto& [gap, answers] : {std::pair{90, 1u}, {110, 0u}}) {
    EXPECT_TRUE(host.send(Bytes(ping.begin(), ping.begin() + 4)).empty());
    bus->advance(bus->time() + std::chrono::milliseconds(gap - 3));
    EXPECT_EQ(host.send(Bytes(ping.begin() + 4, ping.end())).size(), answers) << gap;
  }
  EXPECT_EQ(bus->servo(0).counts().abandoned, 1u);
}

TEST(Scs0009, HasNoSyncReadAndHighByteFirst) {
  const auto bus = bus_of({1}, "scs0009");
  BusHost host(*bus);
  host.use("scs0009");
  EXPECT_EQ(host.read(1, 3, 2), (Bytes{0x05, 0x04}));
  EXPECT_TRUE(host.send(request(feetech::kBroadcast, Instruction::sync_read, {56, 2, 1})).empty());
  EXPECT_TRUE(host.send(request(1, Instruction::set_middle)).empty());
  bus->advance(bus->time() + std::chrono::milliseconds(5));
  EXPECT_EQ(host.get(1, "present_position"), 512);
}

}  // namespace
}  // namespace kaz::sim
