// The protocol of a virtual DYNAMIXEL: the manual's examples, errors, answers and silence, memory, groups.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/dynamixel_servo.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared/base/random.hpp"
#include "sim/bus/bus_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using dynamixel::Failure;
using dynamixel::high;
using dynamixel::low;
using dynamixel::request;
using Op = dynamixel::Instruction;
using std::chrono::milliseconds;

constexpr int kNothing = -1;  // as an error byte: no answer

Bytes bytes_of(const std::string& hex) {
  std::istringstream words(hex);
  Bytes bytes;
  for (unsigned byte; words >> std::hex >> byte;) bytes.push_back(static_cast<std::uint8_t>(byte));
  return bytes;
}

// Without control loops and world: registers keep what the example sets. The parts of a joined answer are put
// together as they stand on the wire.
TEST(ManualExample, OfDynamixelIsAnsweredByteForByte) {
  std::ifstream file("shared/dynamixel/corpus/packets.json");
  int played = 0;
  for (const auto& example : nlohmann::json::parse(file)) {
    SCOPED_TRACE(example.at("name").get<std::string>());
    ++played;
    std::map<int, DynamixelServo> servos;
    const auto* model = servo_bus::find_model(example.value("model", "xm430-w350"));
    for (const auto& [id, registers] : example.at("servos").items()) {
      const int number = std::stoi(id);
      auto& servo = servos.try_emplace(number, *model, number).first->second;
      for (const auto& [name, value] : registers.items()) servo.set_up(name, value.get<int>());
    }
    const auto play = [&](const Bytes& first) {
      // Time, sender, bytes. What one sends, all others hear, in turn.
      std::multimap<Time, std::pair<int, Bytes>> wire{{Time(0), {-1, first}}};
      Bytes joined;
      std::vector<Bytes> answers;
      while (!wire.empty()) {
        const auto [at, sent] = *wire.begin();
        wire.erase(wire.begin());
        if (sent.first >= 0) answers.push_back(sent.second);
        for (auto& [id, servo] : servos) {
          for (const std::uint8_t byte : sent.second) {
            if (id == sent.first) break;
            if (const auto answer = servo.take(byte, at))
              wire.insert({at + answer->delay, {id, answer->bytes}});
          }
        }
      }
      for (const Bytes& part : answers) joined.insert(joined.end(), part.begin(), part.end());
      return example.contains("joined") ? std::vector<Bytes>{joined} : answers;
    };
    if (example.contains("before")) (void)play(bytes_of(example.at("before")));
    std::vector<Bytes> expected;
    for (const std::string text : example.at("answers")) expected.push_back(bytes_of(text));
    EXPECT_EQ(play(bytes_of(example.at("request"))), expected);
    const auto expect_after = [](const DynamixelServo& servo, const nlohmann::json& after) {
      for (const auto& [name, value] : after.items())
        EXPECT_EQ(servo.registers().get(name), value.get<int>()) << name;
    };
    for (auto& [id, servo] : servos) {
      if (example.contains("after")) expect_after(servo, example.at("after"));
      if (example.contains("after_each"))
        expect_after(servo, example.at("after_each").at(std::to_string(id)));
    }
  }
  EXPECT_EQ(played, 30);
}

class Dynamixels : public testing::Test {
 protected:
  void fresh(const std::vector<int>& ids, const std::string& model = "xl330-m288") {
    bus = bus_of(ids, model);
    host.emplace(*bus);
    host->use(model);
    bus->advance(milliseconds(3));
  }
  void wait(Time time) { bus->advance(bus->time() + time); }
  // Error byte of the only answer.
  int error(const dynamixel::Packet& packet, Time patience = milliseconds(3)) {
    const auto answers = host->send(packet, patience);
    return answers.size() == 1 ? answers[0].error : kNothing;
  }
  int error(Op op, Bytes parameters = {}, int id = 1) {
    return error(request(static_cast<std::uint8_t>(id), op, std::move(parameters)));
  }
  static std::vector<int> ids_of(const std::vector<dynamixel::Packet>& answers) {
    std::vector<int> ids;
    for (const auto& answer : answers) ids.push_back(answer.id);
    return ids;
  }
  static dynamixel::Packet sync_read(std::size_t address, std::size_t length, const Bytes& ids,
                                     Op op = Op::sync_read) {
    Bytes parameters{low(address), high(address), low(length), high(length)};
    parameters.insert(parameters.end(), ids.begin(), ids.end());
    return request(dynamixel::kBroadcast, op, parameters);
  }
  std::unique_ptr<VirtualBus> bus;
  std::optional<DynamixelHost> host;
};

TEST_F(Dynamixels, SayWhatIsWrongWithARequest) {
  fresh({1});
  EXPECT_EQ(error(static_cast<Op>(0x77)), 2) << "no such instruction";
  EXPECT_EQ(error(Op::action), 2) << "nothing was registered";
  EXPECT_EQ(error(Op::sync_read, {132, 0, 4, 0, 1}), 2) << "only by broadcast";
  EXPECT_EQ(host->set_with_error(1, "led", 2), 4) << "out of range";
  EXPECT_EQ(host->set_with_error(1, "operating_mode", 2), 4) << "in range, and none";
  EXPECT_EQ(host->write(1, 116, {0, 8}), 5) << "two bytes of four";
  EXPECT_EQ(host->write(1, 118, {0, 0}), 5) << "the last two of four";
  EXPECT_EQ(host->set_with_error(1, "goal_position", 4096), 6) << "beyond a limit";
  EXPECT_EQ(host->set_with_error(1, "goal_position", -1), 6);
  EXPECT_EQ(host->set_with_error(1, "present_position", 1), 7) << "read-only";
  EXPECT_EQ(host->write(1, 66, {1}), 7) << "no register";
  EXPECT_EQ(error(Op::read, {66, 0, 2, 0}), 7);
  EXPECT_EQ(error(Op::read, {0, 4, 2, 0}), 7) << "behind the table";
  ASSERT_TRUE(host->set(1, "torque_enable", 1));
  EXPECT_EQ(host->set_with_error(1, "id", 2), 7) << "EEPROM while the torque is on";
  auto damaged = dynamixel::wire_of(request(1, Op::ping));
  damaged.back() ^= 1;
  const auto answers = host->send(damaged);
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].error, static_cast<int>(Failure::crc));
  damaged = dynamixel::wire_of(request(2, Op::ping));
  damaged.back() ^= 1;
  EXPECT_TRUE(host->send(damaged).empty()) << "of another servo";
}

TEST_F(Dynamixels, WriteOverSeveralRegistersIsDoneWholeOrNotAtAll) {
  fresh({1});
  // profile_acceleration, profile_velocity, goal_position.
  EXPECT_EQ(host->write(1, 108, {10, 0, 0, 0, 20, 0, 0, 0, 0, 4, 0, 0}), 0);
  EXPECT_EQ(host->get(1, "profile_velocity"), 20);
  EXPECT_EQ(host->write(1, 108, {11, 0, 0, 0, 21, 0, 0, 0, 0, 16, 0, 0}), 6);
  EXPECT_EQ(host->get(1, "profile_acceleration"), 10);
  EXPECT_EQ(host->get(1, "profile_velocity"), 20);
  // A read may cross addresses without a register.
  const auto bytes = host->read(1, 64, 5);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(*bytes, (Bytes{0, 0, 0, 0, 2}));
}

TEST_F(Dynamixels, StatusReturnLevelSaysWhatIsAnswered) {
  fresh({1});
  const auto answered = [&](int level) {
    bus->servo(0).registers().set("status_return_level", level);
    std::string all;
    all += error(Op::ping) >= 0 ? "ping " : "";
    all += host->read(1, 132, 4) ? "read " : "";
    all += host->send(sync_read(132, 4, {1})).size() == 1 ? "sync " : "";
    all += host->set(1, "led", level % 2) ? "write " : "";
    EXPECT_EQ(bus->servo(0).registers().get("led"), level % 2) << "executed all the same";
    return all;
  };
  EXPECT_EQ(answered(2), "ping read sync write ");
  EXPECT_EQ(answered(1), "ping read sync ");
  EXPECT_EQ(answered(0), "ping ");
}

TEST_F(Dynamixels, BroadcastsAreExecutedWithoutAnAnswer) {
  fresh({1, 2});
  EXPECT_TRUE(host->send(request(dynamixel::kBroadcast, Op::write, {65, 0, 1})).empty());
  EXPECT_EQ(host->get(1, "led"), 1);
  EXPECT_EQ(host->get(2, "led"), 1);
  EXPECT_TRUE(host->send(request(dynamixel::kBroadcast, Op::read, {65, 0, 1, 0})).empty());
  // All is reset only by name.
  EXPECT_TRUE(host->send(request(dynamixel::kBroadcast, Op::factory_reset, {0xFF})).empty());
  wait(milliseconds(500));
  EXPECT_EQ(host->get(2, "led"), 1);
}

TEST_F(Dynamixels, BroadcastPingIsAnsweredByAllInTheOrderOfTheirIds) {
  fresh({7, 3, 252});
  const auto answers =
      host->send(request(dynamixel::kBroadcast, Op::ping), std::chrono::milliseconds(400));
  EXPECT_EQ(ids_of(answers), (std::vector<int>{3, 7, 252}));
  for (const auto& answer : answers) EXPECT_EQ(answer.parameters, (Bytes{0xB0, 0x04, 53}));
}

TEST_F(Dynamixels, IdAndRateAreThoseOfTheRequestInItsAnswer) {
  fresh({1});
  EXPECT_TRUE(host->set(1, "id", 9));
  EXPECT_TRUE(host->get(9, "id") == 9);
  EXPECT_TRUE(host->set(9, "baud_rate", 2));
  bus->set_host_baud(115200);
  EXPECT_EQ(error(request(9, Op::ping), milliseconds(10)), 0);
}

TEST_F(Dynamixels, SecondaryIdObeysInSilenceAndOnlyInRam) {
  fresh({1, 2});
  ASSERT_TRUE(host->set(1, "secondary_id", 30));
  ASSERT_TRUE(host->set(2, "secondary_id", 30));
  EXPECT_EQ(error(Op::write, {65, 0, 1}, 30), kNothing);
  EXPECT_EQ(host->get(1, "led") + host->get(2, "led"), 2);
  EXPECT_EQ(error(Op::write, {9, 0, 1}, 30), kNothing);
  EXPECT_EQ(host->get(1, "return_delay_time"), 250);
  EXPECT_EQ(error(Op::reg_write, {9, 0, 1}, 30), kNothing);
  EXPECT_EQ(error(Op::action, {}, 30), kNothing);
  EXPECT_EQ(error(Op::factory_reset, {1}, 30), kNothing);
  wait(milliseconds(400));
  EXPECT_EQ(host->get(1, "return_delay_time"), 250);
  EXPECT_EQ(host->get(1, "secondary_id"), 30);
  EXPECT_EQ(error(Op::ping, {}, 30), kNothing);
  ASSERT_TRUE(host->set(1, "secondary_id", 253));
  EXPECT_EQ(error(Op::write, {65, 0, 0}, 253 - 1), kNothing);
  EXPECT_EQ(host->get(1, "led"), 1);
}

TEST_F(Dynamixels, GroupsAreReadInTheOrderOfTheListAndStopAtWhoIsMissing) {
  fresh({1, 2, 3, 4});
  EXPECT_EQ(ids_of(host->send(sync_read(132, 4, {3, 1, 4, 2}), milliseconds(9))),
            (std::vector<int>{3, 1, 4, 2}));
  EXPECT_EQ(ids_of(host->send(sync_read(132, 4, {1, 9, 3, 4}), milliseconds(9))),
            (std::vector<int>{1}));
  EXPECT_EQ(ids_of(host->send(sync_read(132, 4, {3, 4}), milliseconds(9))),
            (std::vector<int>{3, 4}));
  const auto bulk = host->send(request(dynamixel::kBroadcast, Op::bulk_read,
                                       {2, 144, 0, 2, 0, 1, 132, 0, 4, 0, 4, 146, 0, 1, 0}),
                               milliseconds(9));
  EXPECT_EQ(ids_of(bulk), (std::vector<int>{2, 1, 4}));
  ASSERT_EQ(bulk.size(), 3u);
  EXPECT_EQ(bulk[0].parameters, (Bytes{50, 0}));
  EXPECT_EQ(bulk[1].parameters.size(), 4u);
  EXPECT_EQ(bulk[2].parameters, (Bytes{25}));
}

TEST_F(Dynamixels, FastReadsAreOnePacket) {
  fresh({1, 2, 3});
  for (int id = 1; id <= 3; ++id) ASSERT_TRUE(host->set(id, "profile_velocity", 256 * id + 7));
  const auto fast = host->send(sync_read(112, 2, {3, 1, 2}, Op::fast_sync_read), milliseconds(5));
  ASSERT_EQ(fast.size(), 1u);
  EXPECT_EQ(fast[0].id, dynamixel::kBroadcast);
  // Error, id, data, and of all but the last a CRC.
  const Bytes& all = fast[0].parameters;
  ASSERT_EQ(all.size(), 3u * 6 - 2);
  for (const auto& [at, id] : {std::pair<std::size_t, int>{0, 3}, {6, 1}, {12, 2}}) {
    EXPECT_EQ(all[at], 0);
    EXPECT_EQ(all[at + 1], id);
    EXPECT_EQ(all[at + 2] + 256 * all[at + 3], 256 * id + 7);
  }
  const auto bulk = host->send(
      request(dynamixel::kBroadcast, Op::fast_bulk_read, {2, 112, 0, 2, 0, 1, 146, 0, 1, 0}),
      milliseconds(5));
  ASSERT_EQ(bulk.size(), 1u);
  EXPECT_EQ(bulk[0].parameters.size(), 6u + 3);
  // Who is not there ends it; the next request is heard by all.
  EXPECT_TRUE(
      host->send(sync_read(112, 2, {1, 9, 2}, Op::fast_sync_read), milliseconds(5)).empty());
  EXPECT_EQ(host->get(2, "profile_velocity"), 519);
  EXPECT_EQ(host->get(3, "profile_velocity"), 775);
}

TEST_F(Dynamixels, GroupsAreWrittenWithoutAnAnswer) {
  fresh({1, 2, 3});
  EXPECT_TRUE(host->send(request(dynamixel::kBroadcast, Op::sync_write,
                                 {112, 0, 4, 0, 1, 5, 0, 0, 0, 3, 6, 0, 0, 0}))
                  .empty());
  EXPECT_TRUE(host->send(request(dynamixel::kBroadcast, Op::bulk_write,
                                 {2, 65, 0, 1, 0, 1, 1, 108, 0, 4, 0, 9, 0, 0, 0}))
                  .empty());
  EXPECT_EQ(host->get(1, "profile_velocity"), 5);
  EXPECT_EQ(host->get(3, "profile_velocity"), 6);
  EXPECT_EQ(host->get(2, "profile_velocity"), 0);
  EXPECT_EQ(host->get(2, "led"), 1);
  EXPECT_EQ(host->get(1, "profile_acceleration"), 9);
}

TEST_F(Dynamixels, RegWriteWaitsForActionAndIsCheckedAtOnce) {
  fresh({1});
  EXPECT_EQ(error(Op::reg_write, {65, 0, 7}), 4);
  EXPECT_EQ(host->get(1, "registered_instruction"), 0);
  EXPECT_EQ(error(Op::reg_write, {65, 0, 1}), 0);
  EXPECT_EQ(host->get(1, "registered_instruction"), 1);
  EXPECT_EQ(host->get(1, "led"), 0);
  EXPECT_EQ(error(Op::action), 0);
  EXPECT_EQ(host->get(1, "led"), 1);
  EXPECT_EQ(host->get(1, "registered_instruction"), 0);
}

TEST_F(Dynamixels, FactoryResetKeepsWhatItIsToKeep) {
  struct Case {
    std::uint8_t option;
    int id, baud;
  };
  for (const Case& c : {Case{0xFF, 1, 57600}, Case{1, 8, 57600}, Case{2, 8, 1000000}}) {
    fresh({8});
    ASSERT_TRUE(host->set(8, "return_delay_time", 3));
    EXPECT_EQ(error(Op::factory_reset, {c.option}, 8), 0);
    bus->set_host_baud(c.baud);
    EXPECT_EQ(host->get(c.id, "id"), -100000) << "it reboots";
    wait(DynamixelServo::kReboot);
    EXPECT_EQ(host->send(DynamixelWire::read(c.id, 9, 1), milliseconds(9)).at(0).parameters,
              (Bytes{250}));
  }
  fresh({8});
  EXPECT_EQ(error(Op::factory_reset, {3}, 8), 4);
  EXPECT_EQ(error(Op::factory_reset, {}, 8), 2);
}

TEST_F(Dynamixels, RebootForgetsRamAndKeepsEeprom) {
  fresh({1});
  ASSERT_TRUE(host->set(1, "temperature_limit", 60));
  ASSERT_TRUE(host->set(1, "led", 1));
  EXPECT_EQ(error(Op::reboot), 0);
  EXPECT_EQ(error(Op::ping), kNothing);
  wait(DynamixelServo::kReboot);
  EXPECT_EQ(host->get(1, "temperature_limit"), 60);
  EXPECT_EQ(host->get(1, "led"), 0);
}

TEST_F(Dynamixels, BackupIsRestoredWithGainsAtStartIfWanted) {
  fresh({1});
  const Bytes store{1, 0x43, 0x54, 0x52, 0x4C}, restore{2, 0x43, 0x54, 0x52, 0x4C};
  EXPECT_EQ(error(Op::backup, restore), 1) << "there is none";
  ASSERT_TRUE(host->set(1, "torque_enable", 1));
  EXPECT_EQ(error(Op::backup, store), 1) << "the torque is on";
  ASSERT_TRUE(host->set(1, "torque_enable", 0));
  ASSERT_TRUE(host->set(1, "startup_configuration", 2));
  ASSERT_TRUE(host->set(1, "temperature_limit", 61));
  ASSERT_TRUE(host->set(1, "position_p_gain", 777));
  EXPECT_EQ(error(Op::backup, store), 0);
  EXPECT_EQ(host->get(1, "backup_ready"), 1);
  ASSERT_TRUE(host->set(1, "temperature_limit", 62));
  ASSERT_TRUE(host->set(1, "position_p_gain", 5));
  EXPECT_EQ(error(Op::backup, restore), 0);
  wait(DynamixelServo::kReboot);
  EXPECT_EQ(host->get(1, "temperature_limit"), 61);
  EXPECT_EQ(host->get(1, "position_p_gain"), 777);
  EXPECT_EQ(host->get(1, "backup_ready"), 1);
  EXPECT_EQ(error(Op::backup, {3}), 4);
}

TEST_F(Dynamixels, IndirectDataAreTheBytesThatTheyPointAt) {
  fresh({1});
  // torque_enable, led, then the four bytes of profile_velocity.
  const int places[] = {64, 65, 112, 113, 114, 115};
  for (int i = 0; i < 6; ++i) {
    const auto at = static_cast<std::size_t>(places[i]);
    ASSERT_EQ(host->write(1, 168 + 2 * i, {low(at), high(at)}), 0);
  }
  EXPECT_EQ(host->write(1, 224, {0, 1, 0x34, 0x12, 0, 0}), 0);
  EXPECT_EQ(host->get(1, "led"), 1);
  EXPECT_EQ(host->get(1, "profile_velocity"), 0x1234);
  const auto bytes = host->read(1, 224, 6);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(*bytes, (Bytes{0, 1, 0x34, 0x12, 0, 0}));
  EXPECT_EQ(host->write(1, 226, {1, 2}), 5) << "half of a register";
  EXPECT_EQ(host->write(1, 225, {9}), 4) << "the range is that of its target";
  EXPECT_EQ(host->write(1, 168, {63, 0}), 4) << "EEPROM is out of reach";
  EXPECT_EQ(host->write(1, 230, {9}), 0) << "what points at itself is a byte";
  EXPECT_EQ(host->read(1, 230, 1), (Bytes{9}));
}

TEST_F(Dynamixels, SameIdCollides) {
  fresh({1, 1});
  auto& world = static_cast<ShaftWorld&>(bus->world());
  world.joints_[0].angle = 0.5;
  world.joints_[1].angle = -0.7;
  wait(milliseconds(3));
  EXPECT_EQ(error(Op::ping), 0) << "equal answers";
  EXPECT_FALSE(host->read(1, 132, 4));
  EXPECT_EQ(host->counts().bad(), 1u);
}

TEST_F(Dynamixels, BytesTooFarApartAreNoPacket) {
  for (const auto& [gap, answers] : {std::pair{Time(1'400'000), 1u}, {Time(1'600'000), 0u}}) {
    fresh({1});
    const Bytes wire = dynamixel::wire_of(request(1, Op::ping));
    const Time sent = bus->write(std::span(wire).first(5));
    bus->advance(sent + gap - std::chrono::microseconds(10));
    EXPECT_EQ(host->send(Bytes(wire.begin() + 5, wire.end())).size(), answers);
  }
}

// One byte in 1,000 damaged, both ways. Whatever was not executed, the host knows.
TEST_F(Dynamixels, DamageLosesNoCommandSilently) {
  fresh({1, 2});
  for (std::size_t i = 0; i < 2; ++i) bus->servo(i).set_up("return_delay_time", 0);
  bus->line().set_damage(0.001, 7);
  Random random(11);
  int lost = 0, unanswered = 0, wrong = 0;
  constexpr int kCommands = 10000;
  for (int i = 0; i < kCommands; ++i) {
    const int id = 1 + i % 2;
    const auto goal = static_cast<int>(random.below(4096));
    VirtualServo& servo = bus->servo(static_cast<std::size_t>(i % 2));
    // A damaged byte may have changed the registers' own rate or id, were it not for the CRC.
    const bool answered = host->set(id, "goal_position", goal);
    unanswered += answered ? 0 : 1;
    const bool executed = servo.registers().get("goal_position") == goal;
    lost += executed ? 0 : 1;
    wrong += answered && !executed ? 1 : 0;
    // 2 ms of silence end what a damaged length byte began.
    if (!answered) wait(milliseconds(2));
  }
  // 16 bytes of request: some 1.6 %; with the answer's 11, 2.7 %.
  EXPECT_NEAR(lost, 160, 40);
  EXPECT_NEAR(unanswered, 270, 50);
  EXPECT_EQ(wrong, 0);
}

struct CycleCase {
  long baud;
  double goals_ms, block_ms, fast_ms;
};

// Twelve servos without a return delay: sync write of 4 bytes, and sync read of 4, or of 10, or fast of 4.
// Times of the wire alone, computed apart from this code (docs/reference/servo-bus.md).
TEST_F(Dynamixels, CycleOfTwelveTakesTheTimeOfTheWire) {
  const std::vector<int> ids{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const Bytes list(ids.begin(), ids.end());
  Bytes goals{116, 0, 4, 0};
  for (const int id : ids) {
    goals.push_back(static_cast<std::uint8_t>(id));
    goals.insert(goals.end(), {0, 8, 0, 0});
  }
  for (const auto& c :
       {CycleCase{57'600, 48.61, 61.11, 35.42}, CycleCase{1'000'000, 2.80, 3.52, 2.04},
        CycleCase{4'000'000, 0.70, 0.88, 0.51}}) {
    for (const int delay : {0, 250}) {
      fresh(ids);
      const auto& bauds = bus->servo(0).registers().model().bauds;
      const auto code = std::ranges::find(bauds, c.baud) - bauds.begin();
      for (std::size_t i = 0; i < 12; ++i) {
        bus->servo(i).set_up("return_delay_time", delay);
        bus->servo(i).set_up("baud_rate", static_cast<int>(code));
      }
      bus->set_power(true);
      bus->set_host_baud(c.baud);
      const auto cycle = [&](const dynamixel::Packet& read, std::size_t answers) {
        const Time begin = bus->time();
        bus->write(dynamixel::wire_of(request(dynamixel::kBroadcast, Op::sync_write, goals)));
        EXPECT_EQ(host->send(read, milliseconds(100)).size(), answers);
        return 1e3 * seconds(host->last_byte() - begin);
      };
      const double delays = 12 * delay * 2e-3;
      EXPECT_NEAR(cycle(sync_read(132, 4, list), 12), c.goals_ms + delays,
                  0.02 * (c.goals_ms + delays));
      EXPECT_NEAR(cycle(sync_read(126, 10, list), 12), c.block_ms + delays,
                  0.02 * (c.block_ms + delays));
      const double first = delay * 2e-3;
      EXPECT_NEAR(cycle(sync_read(132, 4, list, Op::fast_sync_read), 1), c.fast_ms + first,
                  0.02 * (c.fast_ms + first));
    }
  }
}

}  // namespace
}  // namespace kaz::sim
