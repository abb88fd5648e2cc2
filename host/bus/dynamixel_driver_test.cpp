// A robot on a bus of DYNAMIXEL, which here are registers without motors: what reaches them, what goes wrong.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/dynamixel_driver.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <map>

#include "host/bus/bus_board.h"

namespace kaz::host {
namespace {

using dynamixel::Instruction;
using dynamixel::Packet;
using namespace std::chrono_literals;

// The bus and time: a byte takes 10 us, an answer is there at once.
class Servos final : public Link, public Clock {
 public:
  std::map<int, std::array<std::uint8_t, 256>> registers;
  std::map<int, int> silent;  // requests that a servo does not hear
  int damaged = 0;            // answers to be damaged
  bool echo = false;          // the adapter hands back what was sent
  bool fast = true;           // they have the fast sync read
  std::uint8_t firmware = 53;
  int fast_reads = 0, slow_reads = 0;
  std::vector<Packet> group_writes;
  // Values that a servo refuses with "result fail", or loses, by id and address.
  std::map<std::pair<int, int>, int> refused, lost;

  void add(int id, int position) {
    registers[id].fill(0);
    set(id, 0, 1200, 2);
    set(id, 11, 3, 1);
    set(id, 132, position, 4);
    set(id, 144, 50, 2);
    set(id, 146, 31, 1);
  }
  void set(int id, std::size_t address, int value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      registers[id][address + i] = static_cast<std::uint8_t>(static_cast<unsigned>(value) >> 8 * i);
  }
  int get(int id, std::size_t address, std::size_t size) const {
    unsigned value = 0;
    for (std::size_t i = size; i > 0; --i) value = value << 8 | registers.at(id)[address + i - 1];
    return static_cast<int>(value);
  }
  // An error switches the torque off.
  void report(int id, std::uint8_t hardware_error) {
    set(id, 70, hardware_error, 1);
    if (hardware_error != 0) set(id, 64, 0, 1);
  }

  std::string name() const override { return "the bus"; }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    if (echo) wire_.insert(wire_.end(), bytes.begin(), bytes.end());
    dynamixel::PacketReader reader;
    for (const std::uint8_t byte : bytes) {
      now_ += 10us;
      if (reader.take(byte) == dynamixel::PacketReader::Event::packet) obey(reader.packet());
    }
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    if (wire_.empty()) {
      now_ = std::max(now_, deadline);
      return std::size_t{0};
    }
    const std::size_t count = std::min(bytes.size(), wire_.size());
    std::copy_n(wire_.begin(), count, bytes.begin());
    wire_.erase(wire_.begin(), wire_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  Time now() const override { return now_; }
  Result<void> sleep_until(Time t) override {
    now_ = std::max(now_, t);
    return {};
  }

 private:
  void answer(int id, std::vector<std::uint8_t> parameters, int error = 0) {
    const int alert = get(id, 70, 1) != 0 ? dynamixel::kAlert : 0;
    auto bytes = dynamixel::wire_of(
        {static_cast<std::uint8_t>(id), static_cast<std::uint8_t>(Instruction::status),
         static_cast<std::uint8_t>(error | alert), std::move(parameters)});
    if (damaged > 0) {
      --damaged;
      bytes[bytes.size() / 2] ^= 0x10;
    }
    wire_.insert(wire_.end(), bytes.begin(), bytes.end());
  }
  bool hears(int id) {
    if (!registers.contains(id)) return false;
    return silent[id] == 0 || silent[id]-- < 0;
  }
  static bool takes_not(const std::map<std::pair<int, int>, int>& values, int id, int address,
                        int value) {
    const auto found = values.find({id, address});
    return found != values.end() && found->second == value;
  }
  void answer_block(int id, const std::vector<std::uint8_t>& p) {
    const auto begin = registers.at(id).begin() + p[0];
    answer(id, {begin, begin + p[2]});
  }
  // In one packet, with the CRC of all before behind each servo's part.
  void answer_fast(const std::vector<std::uint8_t>& p) {
    const std::size_t length = 1 + (p.size() - 4) * (p[2] + std::size_t{4});
    std::vector<std::uint8_t> bytes{
        0xFF, 0xFF, 0xFD, 0, 254, dynamixel::low(length), dynamixel::high(length), 0x55};
    for (std::size_t i = 4; i < p.size(); ++i) {
      if (!hears(p[i])) return;  // those behind it wait for it
      bytes.push_back(get(p[i], 70, 1) != 0 ? dynamixel::kAlert : std::uint8_t{0});
      bytes.push_back(p[i]);
      const auto begin = registers.at(p[i]).begin() + p[0];
      bytes.insert(bytes.end(), begin, begin + p[2]);
      const std::uint16_t crc = dynamixel::crc16(bytes);
      bytes.insert(bytes.end(), {dynamixel::low(crc), dynamixel::high(crc)});
    }
    if (damaged > 0) {
      --damaged;
      bytes[bytes.size() / 2] ^= 0x10;
    }
    wire_.insert(wire_.end(), bytes.begin(), bytes.end());
  }
  void obey(const Packet& packet) {
    const auto& p = packet.parameters;
    const auto instruction = static_cast<Instruction>(packet.instruction);
    if (instruction == Instruction::fast_sync_read) {
      ++fast_reads;
      if (fast) answer_fast(p);
    } else if (instruction == Instruction::sync_read) {
      ++slow_reads;
      for (std::size_t i = 4; i < p.size(); ++i) {
        if (!hears(p[i])) return;  // those behind it wait for its answer
        answer_block(p[i], p);
      }
    } else if (instruction == Instruction::sync_write) {
      group_writes.push_back(packet);
      for (std::size_t i = 4; i + p[2] < p.size(); i += p[2] + 1u) {
        if (!hears(p[i]) || takes_not(refused, p[i], p[0], p[i + 1]) ||
            takes_not(lost, p[i], p[0], p[i + 1]))
          continue;
        for (std::size_t k = 0; k < p[2]; ++k) registers[p[i]][p[0] + k] = p[i + 1 + k];
      }
    } else if (hears(packet.id)) {
      if (instruction == Instruction::ping) return answer(packet.id, {0xB0, 0x04, firmware});
      if (instruction == Instruction::read) return answer_block(packet.id, p);
      if (instruction == Instruction::reboot) {
        answer(packet.id, {});
        report(packet.id, 0);
        silent[packet.id] = 5;
        return;
      }
      const bool torque = p.size() == 3 && p[0] == 64 && p[2] != 0;
      if (torque && get(packet.id, 70, 1) != 0) return answer(packet.id, {}, 1);
      if (takes_not(refused, packet.id, p[0], p[2])) return answer(packet.id, {}, 1);
      if (takes_not(lost, packet.id, p[0], p[2])) return;
      for (std::size_t k = 2; k < p.size(); ++k) registers[packet.id][p[0] + k - 2] = p[k];
      answer(packet.id, {});
    }
  }

  std::deque<std::uint8_t> wire_;
  Time now_{1s};
};

const servo_bus::Model& xl330() {
  return *servo_bus::find_model("xl330-m288");
}

class Driver : public testing::Test {
 protected:
  void SetUp() override {
    servos.add(1, 2048);
    servos.add(2, 1000);
  }
  Servos servos;
  servo_bus::BusServo pan{"pan", 1, &xl330(), 2048, false}, lift{"lift", 2, &xl330(), 1000, true};
  DynamixelDriver driver{servos, servos};
};

TEST_F(Driver, GreetsAndReadsMotionOftenAndTheCircuitSeldom) {
  servos.echo = true;
  servos.set(1, 108, 99, 4);
  const auto greeting = driver.greet(pan).value();
  ASSERT_TRUE(greeting);
  EXPECT_EQ(greeting->model, 1200);
  EXPECT_EQ(greeting->mode, 3);
  EXPECT_EQ(greeting->refused, "");
  EXPECT_EQ(servos.get(1, 108, 4), 0) << "no acceleration besides the board's ramps";
  servo_bus::BusServo none{"none", 9, &xl330(), 2048, false};
  EXPECT_FALSE(driver.greet(none).value());

  servos.set(1, 124, -443, 2);
  servos.set(1, 128, 64, 4);
  servos.set(2, 132, -5000, 4);
  const std::array<const servo_bus::BusServo*, 2> both{&pan, &lift};
  const auto states = driver.read_all(both).value();
  ASSERT_TRUE(states[0] && states[1]);
  EXPECT_NEAR(states[0]->duty, -0.5, 1e-3);
  EXPECT_NEAR(states[0]->speed, 1000, 1e-9);
  EXPECT_EQ(states[1]->steps, -5000);
  EXPECT_EQ(states[0]->volts, 5);
  EXPECT_EQ(states[0]->celsius, 31);
  const auto requests = driver.counts().requests;
  EXPECT_TRUE(std::isnan(driver.read_all(both).value()[0]->volts));
  EXPECT_EQ(driver.counts().requests, requests + 1) << "one for all";
  (void)servos.sleep_until(servos.now() + 500ms);
  EXPECT_EQ(driver.read_all(both).value()[0]->volts, 5);
}

TEST_F(Driver, ReadsAllInOnePacketWhereTheyHaveIt) {
  const std::array<const servo_bus::BusServo*, 2> both{&pan, &lift};
  // A header in the data: nothing is put into a joined answer.
  servos.set(1, 132, 0x00FDFFFF, 4);
  servos.report(2, dynamixel::kOverloadError);
  for (int i = 0; i < 5; ++i) {
    const auto states = driver.read_all(both).value();
    ASSERT_TRUE(states[0] && states[1]);
    EXPECT_EQ(states[0]->steps, 0x00FDFFFF);
    EXPECT_EQ(states[1]->steps, 1000);
    EXPECT_EQ(states[0]->trouble, 0);
    EXPECT_EQ(states[1]->trouble, kTroubleOverload);
  }
  EXPECT_EQ(servos.fast_reads, 6) << "and one of the circuit";
  EXPECT_EQ(servos.slow_reads, 0);
  // A lost answer costs one cycle's speed; they stay fast.
  servos.silent[2] = 1;
  EXPECT_TRUE(driver.read_all(both).value()[1]);
  EXPECT_EQ(servos.slow_reads, 1);
  EXPECT_TRUE(driver.read_all(both).value()[1]);
  EXPECT_EQ(servos.slow_reads, 1);
  // One alone is read as ever.
  const std::array<const servo_bus::BusServo*, 1> one{&pan};
  const int fast = servos.fast_reads;
  EXPECT_TRUE(driver.read_all(one).value()[0]);
  EXPECT_EQ(servos.fast_reads, fast);
}

TEST_F(Driver, FallsBackWhereTheyDoNot) {
  const std::array<const servo_bus::BusServo*, 2> both{&pan, &lift};
  servos.fast = false;
  for (int i = 0; i < 10; ++i) {
    const auto states = driver.read_all(both).value();
    ASSERT_TRUE(states[0] && states[1]);
    EXPECT_EQ(states[1]->steps, 1000);
  }
  EXPECT_EQ(servos.fast_reads, 2) << "then no more";
  EXPECT_EQ(driver.counts().missing, 0u);
  // A firmware that is too old is not tried.
  Servos old;
  old.add(1, 2048);
  old.add(2, 1000);
  old.firmware = 45;
  DynamixelDriver other(old, old);
  ASSERT_TRUE(other.greet(pan).value());
  ASSERT_TRUE(other.read_all(both).value()[1]);
  EXPECT_EQ(old.fast_reads, 0);
}

TEST_F(Driver, OneWriteMovesAll) {
  const BusDriver::Goal goals[] = {{&pan, 2148.4, 1000}, {&lift, 900, 0}};
  ASSERT_TRUE(driver.move(goals));
  ASSERT_EQ(servos.group_writes.size(), 1u);
  EXPECT_EQ(servos.group_writes[0].parameters.size(), 4u + 2 * 9);
  EXPECT_EQ(servos.get(1, 112, 4), 64);
  EXPECT_EQ(servos.get(1, 116, 4), 2148);
  EXPECT_EQ(servos.get(2, 112, 4), 1) << "0 would be the highest speed";
  EXPECT_EQ(servos.get(2, 116, 4), 900);
}

TEST_F(Driver, LostAndDamagedAnswersAreRequestedAgain) {
  const std::array<const servo_bus::BusServo*, 2> both{&pan, &lift};
  for (int i = 0; i < 20; ++i) {
    if (i % 4 == 0) servos.silent[1] = 1;
    if (i % 4 == 2) servos.damaged = 1;
    const auto states = driver.read_all(both).value();
    EXPECT_TRUE(states[0] && states[1]) << i;
  }
  EXPECT_EQ(driver.counts().missing, 0u);
  EXPECT_EQ(driver.counts().damaged, 5u);
  servos.silent[2] = 1000;
  EXPECT_FALSE(driver.read_all(both).value()[1]);
  EXPECT_GT(driver.counts().missing, 0u);
}

TEST_F(Driver, AShutdownIsNamedAndEndedByAReboot) {
  const std::array<const servo_bus::BusServo*, 2> both{&pan, &lift};
  ASSERT_TRUE(driver.hold(pan, 2048).value());
  EXPECT_EQ(servos.get(1, 116, 4), 2048);
  const std::pair<int, int> cases[] = {{dynamixel::kOverloadError, kTroubleOverload},
                                       {dynamixel::kTemperatureError, kTroubleHeat},
                                       {dynamixel::kVoltageError, kTroubleVoltage},
                                       {dynamixel::kShockError, kTroubleVoltage},
                                       {dynamixel::kEncoderError, kTroubleSensor}};
  for (const auto& [error, trouble] : cases) {
    servos.report(1, static_cast<std::uint8_t>(error));
    EXPECT_EQ(driver.read_all(both).value()[0]->trouble, trouble);
  }
  EXPECT_FALSE(driver.hold(pan, 2048).value()) << "refused";
  const BusDriver::Goal troubled[] = {{&pan, 2048, 0}};
  ASSERT_TRUE(driver.recover(troubled));
  EXPECT_EQ(driver.read_all(both).value()[0]->trouble, 0);
  EXPECT_TRUE(driver.hold(pan, 2048).value());
}

constexpr int kTorque = 64, kGoal = 116, kAcceleration = 108;

TEST_F(Driver, OffIsWhatTheServoSaysWhenItIsReadBack) {
  using enum BusDriver::Torque;
  const std::array<const servo_bus::BusServo*, 2> both{&pan, &lift};
  const auto hold = [&] {
    EXPECT_TRUE(driver.hold(pan, 2048).value());
    EXPECT_TRUE(driver.hold(lift, 1000).value());
  };
  hold();
  const auto requests = driver.counts().requests;
  EXPECT_EQ(driver.release(both).value(), (std::vector{off, off}));
  EXPECT_EQ(driver.counts().requests, requests + 3) << "one write for all, and a reading of each";
  hold();
  servos.refused[{1, kTorque}] = 0;
  servos.lost[{2, kTorque}] = 0;
  auto torque = driver.release(both).value();
  EXPECT_EQ(torque, (std::vector{on, on}));
  EXPECT_EQ(still_on(both, torque),
            "pan (id 1) still has torque; lift (id 2) still has torque: cut the power");
  servos.refused.clear();
  servos.lost.clear();
  servos.silent[2] = 1000;
  torque = driver.release(both).value();
  EXPECT_EQ(torque, (std::vector{off, silent}));
  EXPECT_EQ(still_on(both, torque),
            "lift (id 2) does not confirm that its torque is off: cut the power");
}

TEST_F(Driver, HoldsOnlyWhereTheGoalIsAccepted) {
  for (auto* values : {&servos.refused, &servos.lost}) {
    (*values)[{1, kGoal}] = 2100 & 0xFF;
    EXPECT_FALSE(driver.hold(pan, 2100).value());
    EXPECT_EQ(servos.get(1, kTorque, 1), 0);
    values->clear();
  }
  EXPECT_TRUE(driver.hold(pan, 2100).value());
  EXPECT_EQ(servos.get(1, kGoal, 4), 2100);
}

TEST_F(Driver, AServoThatKeepsAnAccelerationIsNotDriven) {
  servos.set(1, kAcceleration, 50, 4);
  servos.refused[{1, kAcceleration}] = 0;
  EXPECT_EQ(driver.greet(pan).value()->refused, "profile_acceleration");
  const BusDriver::Goal troubled[] = {{&pan, 2048, 0}, {&lift, 1000, 0}};
  EXPECT_EQ(driver.recover(troubled).value(), (std::vector{false, true}));
  auto opened = BusBoard::open(servos, servos, {{pan, -1, 1}, {lift, -1, 1}});
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message.find("does not accept 0 for its register profile_acceleration"),
            std::string::npos)
      << opened.error().message;
}

TEST_F(Driver, ABoardNamesWhatIsNotRight) {
  const auto refusal = [&](std::vector<BusJoint> joints) {
    const auto opened = BusBoard::open(servos, servos, std::move(joints));
    return opened ? std::string("opened") : opened.error().message;
  };
  EXPECT_EQ(refusal({{pan, -1, 1}, {lift, -1, 1}}), "opened");
  servos.set(2, 11, 4, 1);
  EXPECT_NE(refusal({{pan, -1, 1}, {lift, -1, 1}})
                .find("servo 2 (lift) on the bus is in mode 4: only the position mode, 3,"),
            std::string::npos);
  auto other = lift;
  other.model = servo_bus::find_model("xl430-w250");
  EXPECT_NE(refusal({{pan, -1, 1}, {other, -1, 1}}).find("has model number 1200"),
            std::string::npos);
  other.model = servo_bus::find_model("sts3215");
  EXPECT_NE(refusal({{pan, -1, 1}, {other, -1, 1}}).find("two protocols"), std::string::npos);
  other = lift;
  other.id = 7;
  EXPECT_NE(refusal({{pan, -1, 1}, {other, -1, 1}}).find("(dynamixel:PATH@BAUD)"),
            std::string::npos);
}

}  // namespace
}  // namespace kaz::host
