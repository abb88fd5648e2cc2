// A robot on a bus of servos, which here are registers without motors: what reaches them, what goes wrong.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/bus_board.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <map>

#include "host/bus/bus_scan.h"
#include "host/link/stalling_testing.h"
#include "host/robot/robot.h"
#include "shared/feetech/packet.h"

namespace kaz::host {
namespace {

using feetech::Instruction;
using feetech::Packet;
using namespace std::chrono_literals;

// The bus and time: a byte takes 10 us, an answer is there at once.
class Servos final : public Link, public Clock {
 public:
  std::map<int, std::array<std::uint8_t, 256>> registers;
  std::map<int, std::uint8_t> error;  // status byte of the answers
  std::map<int, int> silent;          // requests that a servo does not hear
  int damaged = 0;                    // answers to be damaged
  int writes = 0;
  // Writes of this value that a servo loses although it hears the rest, by id and address.
  struct Lost {
    int value, count;
  };
  std::map<std::pair<int, int>, Lost> lost;
  bool mute = false;      // writes are done and not answered
  bool flooding = false;  // bytes come without end

  void add(int id, int position) {
    auto& bytes = registers[id];
    bytes.fill(0);
    set(id, 3, 777);
    set(id, 56, position);
    bytes[62] = 74;
    bytes[63] = 30;
  }
  void set(int id, std::size_t address, int value) {
    registers[id][address] = static_cast<std::uint8_t>(value);
    registers[id][address + 1] = static_cast<std::uint8_t>(value >> 8);
  }
  int get(int id, std::size_t address) const {
    return registers.at(id)[address] | registers.at(id)[address + 1] << 8;
  }

  std::string name() const override { return "the bus"; }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    feetech::PacketReader reader;
    for (const std::uint8_t byte : bytes) {
      now_ += 10us;
      if (reader.take(byte) == feetech::PacketReader::Event::packet) obey(reader.packet());
    }
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    if (flooding) {
      std::ranges::fill(bytes, 0x55);
      return bytes.size();
    }
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
  void answer(int id, std::vector<std::uint8_t> parameters) {
    auto bytes =
        feetech::wire_of({static_cast<std::uint8_t>(id), error[id], std::move(parameters)});
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
  // False: it did not arrive. A goal switches the torque on.
  bool write(int id, std::size_t address, std::span<const std::uint8_t> bytes) {
    const auto losing = lost.find({id, static_cast<int>(address)});
    if (losing != lost.end() && losing->second.count != 0 && losing->second.value == bytes[0]) {
      --losing->second.count;
      return false;
    }
    std::ranges::copy(bytes, registers[id].begin() + static_cast<std::ptrdiff_t>(address));
    if (address == 42) registers[id][40] = 1;
    return true;
  }
  std::vector<std::uint8_t> bytes_of(int id, std::size_t address, std::size_t count) const {
    const auto& all = registers.at(id);
    return {all.begin() + static_cast<std::ptrdiff_t>(address),
            all.begin() + static_cast<std::ptrdiff_t>(address + count)};
  }
  void obey(const Packet& packet) {
    const auto& p = packet.parameters;
    const auto instruction = static_cast<Instruction>(packet.code);
    if (packet.id == feetech::kBroadcast && instruction == Instruction::sync_read) {
      for (std::size_t i = 2; i < p.size(); ++i) {
        if (!hears(p[i])) return;  // those behind it wait for its answer
        answer(p[i], bytes_of(p[i], p[0], p[1]));
      }
    } else if (packet.id == feetech::kBroadcast && instruction == Instruction::sync_write) {
      ++writes;
      for (std::size_t i = 2; i + p[1] < p.size(); i += p[1] + 1u) {
        if (hears(p[i])) (void)write(p[i], p[0], std::span(p).subspan(i + 1, p[1]));
      }
    } else if (hears(packet.id)) {
      if (instruction == Instruction::read) {
        answer(packet.id, bytes_of(packet.id, p[0], p[1]));
        return;
      }
      if (instruction == Instruction::write) {
        ++writes;
        if (!write(packet.id, p[0], std::span(p).subspan(1)) || mute) return;
      }
      answer(packet.id, {});
    }
  }

  std::deque<std::uint8_t> wire_;
  Time now_{1s};
};

// The board over them, as Robot sees it.
class BoardLink final : public Link {
 public:
  BoardLink(BusBoard& board, Servos& servos) : board_(board), servos_(servos) {}
  std::string name() const override { return "the bus"; }
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    board_.take(bytes);
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> bytes, Time deadline) override {
    if (waiting_.empty()) {
      const auto answer = KAZ_TRY(board_.serve());
      if (answer) waiting_ = *answer;
    }
    if (waiting_.empty()) return servos_.read(bytes, deadline);
    const std::size_t count = std::min(bytes.size(), waiting_.size());
    std::copy_n(waiting_.begin(), count, bytes.begin());
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }

 private:
  BusBoard& board_;
  Servos& servos_;
  std::vector<std::uint8_t> waiting_;
};

template <class Message>
std::vector<u8> frame_of(u8 type, const Message& message, u8 (*pack)(const Message*, u8*)) {
  std::array<u8, KZ_PAYLOAD_MAX> fields{};
  const u8 size = pack(&message, fields.data());
  std::vector<u8> body{KZ_ADDRESS_DEFAULT, type, 7};
  body.insert(body.end(), fields.begin(), fields.begin() + size);
  std::vector<u8> wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

std::vector<BusJoint> two_joints() {
  const servo_bus::Model* model = servo_bus::find_model("sts3215");
  return {{{"pan", 1, model, 2048, false}, -1.5, 1.5}, {{"lift", 2, model, 1000, true}, -1, 1.5}};
}

class ServoRobot : public testing::Test {
 protected:
  void SetUp() override {
    servos.add(1, 2048);
    servos.add(2, 1000);
    auto opened = BusBoard::open(servos, servos, two_joints());
    ASSERT_TRUE(opened) << opened.error().message;
    board.emplace(std::move(*opened));
    link.emplace(*board, servos);
    auto connected =
        Robot::connect(*link, servos, {.reconnect = Time::zero(), .joint_names = {"pan", "lift"}});
    ASSERT_TRUE(connected) << connected.error().message;
    robot.emplace(std::move(*connected));
  }
  Servos servos;
  std::optional<BusBoard> board;
  std::optional<BoardLink> link;
  std::optional<Robot> robot;
};

TEST_F(ServoRobot, HoldsWhereItIsAndTurnsToItsTargets) {
  servos.set(1, 56, 2048 + 100);
  (void)servos.sleep_until(servos.now() + 10ms);
  ASSERT_TRUE(robot->enable(0b11));
  EXPECT_EQ(servos.registers[1][40], 1);
  EXPECT_EQ(servos.get(1, 42), 2148) << "the goal is where it is";
  ASSERT_TRUE(robot->set_targets({{{0, 0.5}, {1, 0.25}}}, 500ms));
  const double steps = 4096 / (2 * 3.14159265358979);
  EXPECT_NEAR(servos.get(1, 42), 2048 + 0.5 * steps, 1);
  EXPECT_NEAR(servos.get(2, 42), 1000 - 0.25 * steps, 1) << "it is mounted the other way round";
  // 0.25 rad in 0.5 s.
  EXPECT_NEAR(servos.get(2, 46), 0.5 * steps, 2);
  // One of many: as fast as the ramp allows, 6 rad/s.
  ASSERT_TRUE(robot->set_targets({{{1, 0.3}}}, 12ms));
  EXPECT_NEAR(servos.get(2, 46), 6 * steps, 2);
  EXPECT_NEAR(robot->read_targets().value()[1], 0.3, 1e-4);

  servos.set(2, 56, 1000 - 652);
  (void)servos.sleep_until(servos.now() + 10ms);
  const auto state = robot->state();
  ASSERT_TRUE(state);
  EXPECT_NEAR(state->angle[1], 1.0, 2e-3);
  EXPECT_NEAR(state->supply_volts, 7.4, 1e-3);
  EXPECT_EQ(state->angle[5], 0) << "a joint that is none";
  EXPECT_TRUE(robot->disable_all());
  EXPECT_EQ(servos.registers[1][40], 0);
  EXPECT_EQ(servos.registers[2][40], 0);
}

TEST(BusBoard, AJointIsNotFasterThanItsLimit) {
  Servos servos;
  servos.add(1, 2048);
  servos.add(2, 1000);
  auto joints = two_joints();
  joints[0].max_rad_per_s = 0.25;
  auto board = BusBoard::open(servos, servos, joints);
  ASSERT_TRUE(board) << board.error().message;
  BoardLink link(*board, servos);
  auto robot =
      Robot::connect(link, servos, {.reconnect = Time::zero(), .joint_names = {"pan", "lift"}});
  ASSERT_TRUE(robot) << robot.error().message;
  ASSERT_TRUE(robot->set_limits(0b11, {.ramp_rad_per_s = 3, .lower_rad = -1, .upper_rad = 1}));
  EXPECT_NEAR(robot->settings(0)->limits.ramp_rad_per_s, 0.2, 1e-9) << "in steps of 0.1 rad/s";
  EXPECT_NEAR(robot->settings(1)->limits.ramp_rad_per_s, 3, 1e-9);
  ASSERT_TRUE(robot->enable(0b11));
  const double steps = 4096 / (2 * 3.14159265358979);
  ASSERT_TRUE(robot->set_targets({{{0, 0.5}, {1, 0.5}}}, 12ms));
  EXPECT_NEAR(servos.get(1, 46), 0.2 * steps, 1);
  EXPECT_NEAR(servos.get(2, 46), 3 * steps, 2);
}

constexpr int kTorque = 40, kGoal = 42, kFor = 1'000'000;

TEST_F(ServoRobot, AnOffThatIsLostIsWrittenAgain) {
  for (const int times : {1, 2, 3}) {
    ASSERT_TRUE(robot->enable(0b11));
    servos.lost[{1, kTorque}] = {0, times};
    servos.lost[{2, kTorque}] = {0, times};
    const auto off = robot->disable_all();
    EXPECT_TRUE(off) << times << ": " << off.error().message;
    EXPECT_EQ(servos.registers[1][kTorque], 0) << times;
    EXPECT_EQ(servos.registers[2][kTorque], 0) << times;
    EXPECT_EQ(board->still_on(), "");
  }
}

TEST_F(ServoRobot, AServoThatKeepsItsTorqueStaysOnAndIsNamed) {
  ASSERT_TRUE(robot->enable(0b11));
  servos.lost[{1, kTorque}] = {0, kFor};
  const auto stopped = robot->stop();
  ASSERT_FALSE(stopped);
  EXPECT_NE(stopped.error().message.find("motors are still on"), std::string::npos);
  EXPECT_EQ(servos.registers[2][kTorque], 0);
  EXPECT_EQ(board->still_on(), "pan (id 1) still has torque: cut the power");
  (void)servos.sleep_until(servos.now() + 10ms);
  const auto state = robot->state();
  ASSERT_TRUE(state);
  EXPECT_EQ(state->status, KZ_SHUTDOWN_STOP << 8 | KZ_STATUS_ENABLED);
  EXPECT_NE(robot->describe_fault(state->status).find("not all motors confirm"), std::string::npos);
  const auto details = robot->joints(0b11);
  ASSERT_TRUE(details);
  EXPECT_NE((*details)[0].flags & KZ_JOINT_ON, 0);
  EXPECT_EQ((*details)[1].flags & KZ_JOINT_ON, 0);
  EXPECT_FALSE(robot->set_targets({{{0, 0.1}}}, 100ms)) << "it takes none";
  const auto off = robot->disable_all();
  ASSERT_FALSE(off);
  EXPECT_NE(
      off.error().message.find("the motors on the bus are off (still on: pan): cut their power"),
      std::string::npos)
      << off.error().message;
  const auto other = robot->enable(0b10);
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("still on: pan"), std::string::npos)
      << other.error().message;
  ASSERT_FALSE(robot->disable_all());

  // Readings alone switch it off once that is possible.
  servos.lost.clear();
  for (int i = 0; i < 3 && !board->still_on().empty(); ++i) {
    (void)servos.sleep_until(servos.now() + 10ms);
    ASSERT_TRUE(robot->state());
  }
  EXPECT_EQ(board->still_on(), "");
  EXPECT_EQ(servos.registers[1][kTorque], 0);
  EXPECT_TRUE(robot->disable_all());
  EXPECT_TRUE(robot->enable(0b11));
}

TEST_F(ServoRobot, AServoThatIsSilentDoesNotConfirm) {
  ASSERT_TRUE(robot->enable(0b11));
  servos.silent[2] = kFor;
  const Time begin = servos.now();
  ASSERT_FALSE(robot->stop());
  EXPECT_LT(servos.now() - begin, 400ms);
  EXPECT_EQ(servos.registers[1][kTorque], 0);
  EXPECT_EQ(board->still_on(),
            "lift (id 2) does not confirm that its torque is off: cut the power");
  servos.lost[{1, kTorque}] = {0, kFor};
  servos.registers[1][kTorque] = 1;
  ASSERT_FALSE(robot->disable_all());
  EXPECT_EQ(board->still_on(),
            "pan (id 1) still has torque; lift (id 2) does not confirm that its torque is off: cut "
            "the power");
  servos.lost.clear();
  servos.silent[2] = 0;
  EXPECT_TRUE(robot->disable_all());
  EXPECT_EQ(servos.registers[2][kTorque], 0);
}

TEST_F(ServoRobot, AnErrorInTheAnswersChangesNothing) {
  ASSERT_TRUE(robot->enable(0b11));
  servos.error[1] = servos.error[2] = feetech::kVoltageError;
  servos.lost[{1, kTorque}] = {0, kFor};
  (void)robot->stop();
  EXPECT_EQ(board->still_on(), "pan (id 1) still has torque: cut the power");
  EXPECT_EQ(servos.registers[2][kTorque], 0);
}

// Waiting for one that keeps its torque must not make the others' cycles late.
TEST_F(ServoRobot, AServoThatKeepsItsTorqueCostsACycleTwoRequests) {
  const auto requests_of_a_cycle = [&] {
    (void)servos.sleep_until(servos.now() + 10ms);
    const auto before = board->counts().requests;
    EXPECT_TRUE(robot->state());
    return board->counts().requests - before;
  };
  ASSERT_TRUE(robot->enable(0b11));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(requests_of_a_cycle(), 1u);
  servos.lost[{1, kTorque}] = {0, kFor};
  EXPECT_FALSE(robot->enable(0b10));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(requests_of_a_cycle(), 3u);
}

TEST_F(ServoRobot, HoldsOnlyWhereTheGoalIsAccepted) {
  servos.set(1, 56, 2148);
  servos.lost[{1, kGoal}] = {2148 & 0xFF, kFor};
  const auto enabled = robot->enable(0b11);
  ASSERT_FALSE(enabled);
  EXPECT_NE(enabled.error().message.find("still off: pan"), std::string::npos)
      << enabled.error().message;
  EXPECT_EQ(servos.registers[1][kTorque], 0);
  EXPECT_EQ(servos.registers[2][kTorque], 1);
  EXPECT_FALSE(robot->set_targets({{{0, 0.1}}}, 100ms));
  EXPECT_TRUE(robot->disable_all());
  // Nor where it has not just said where it is: all tries of a reading.
  servos.lost.clear();
  servos.silent[1] = 3;
  board->take(frame_of(KZ_TYPE_enable, kz_enable{0b11}, kz_pack_enable));
  ASSERT_TRUE(board->serve());
  EXPECT_EQ(servos.registers[1][kTorque], 0);
  EXPECT_EQ(servos.registers[2][kTorque], 1);
  // A servo may answer reads alone: what is read back counts.
  servos.mute = true;
  EXPECT_TRUE(robot->enable(0b11));
  EXPECT_EQ(servos.get(1, kGoal), 2148);
  EXPECT_TRUE(robot->disable_all());
  EXPECT_EQ(servos.registers[1][kTorque], 0);
}

// The goal that ends an overload switches the torque on.
TEST_F(ServoRobot, ClearingAnOverloadLeavesTheTorqueOff) {
  ASSERT_TRUE(robot->enable(0b11));
  servos.error[2] = feetech::kOverloadError;
  (void)servos.sleep_until(servos.now() + 10ms);
  (void)robot->state();
  servos.lost[{2, kTorque}] = {0, 3};
  EXPECT_FALSE(robot->clear());
  EXPECT_EQ(board->still_on(), "");
  EXPECT_EQ(servos.registers[2][kTorque], 0);
  // Nor is it cleared while the servo does not accept the goal.
  servos.set(2, 56, 900);
  servos.lost[{2, kGoal}] = {900 & 0xFF, kFor};
  EXPECT_FALSE(robot->clear());
  servos.error[2] = 0;
  EXPECT_FALSE(robot->clear());
  servos.lost.clear();
  EXPECT_TRUE(robot->clear());
}

TEST_F(ServoRobot, AFloodIsAnErrorAndTheTorqueGoesOffAllTheSame) {
  ASSERT_TRUE(robot->enable(0b11));
  servos.flooding = true;
  const auto off = robot->disable_all();
  ASSERT_FALSE(off);
  EXPECT_NE(off.error().message.find("unrequested bytes keep arriving"), std::string::npos)
      << off.error().message;
  EXPECT_EQ(servos.registers[1][kTorque], 0);
  EXPECT_EQ(servos.registers[2][kTorque], 0);
  EXPECT_EQ(board->still_on(),
            "pan (id 1) does not confirm that its torque is off; lift (id 2) does not confirm that "
            "its torque is off: cut the power");
  const auto found = scan_bus(servos, servos, servo_bus::Protocol::feetech, 1000000, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().fault, Fault::environment);
}

// A servo whose answer this machine read too late is not called missing, and its cable not blamed.
TEST_F(ServoRobot, AScanOnABusyMachineRepeatsWhatWasLate) {
  StallingLine line(servos, servos);
  LatenessMeter meter(line, line);
  std::map<int, std::string> undecided;
  ScanOptions options;
  options.last_id = 4;
  options.lateness = &meter;
  options.undecided = [&](int id, const std::string& why) { undecided[id] = why; };
  line.length = 40ms;
  line.stalls = 8;  // the first requests to id 0, two runs of each
  line.pause = 1ms;
  servos.silent[1] = 1;  // heard in the repetition alone
  auto found = scan_bus(meter, meter, servo_bus::Protocol::feetech, 1000000, options).value();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(undecided.empty());
  for (const ScannedServo& servo : found) {
    EXPECT_EQ(servo.lost + servo.damaged + servo.late, 0) << servo.id;
    for (const ScanRemark& remark : remarks_on(servo, servo_bus::Protocol::feetech))
      EXPECT_FALSE(remark.wrong) << remark.text;
  }
  // Late each time: it is not known who is there.
  line.stalls = 1'000'000;
  servos.silent[2] = 1'000'000;
  found = scan_bus(meter, meter, servo_bus::Protocol::feetech, 1000000, options).value();
  ASSERT_EQ(undecided.size(), 4u);
  EXPECT_TRUE(undecided.contains(2));
  EXPECT_NE(undecided[2].find("this program was kept waiting for up to"), std::string::npos)
      << undecided[2];
  // A silent servo of a punctual machine is missing.
  line.stalls = 0;
  undecided.clear();
  found = scan_bus(meter, meter, servo_bus::Protocol::feetech, 1000000, options).value();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(undecided.empty());
}

// Requests that were never served, since the line failed or the host was interrupted, must not delay an off.
TEST_F(ServoRobot, AnOffDoesNotWaitForEarlierRequests) {
  const auto off = [this](bool stop) { return stop ? robot->stop() : robot->disable_all(); };
  for (const bool stop : {false, true}) {
    servos.flooding = false;
    (void)robot->clear();
    ASSERT_TRUE(robot->enable(0b11));
    board->take(frame_of(KZ_TYPE_enable, kz_enable{0b11}, kz_pack_enable));
    board->take(frame_of(KZ_TYPE_joints, kz_joints{0b11}, kz_pack_joints));
    servos.flooding = true;
    EXPECT_FALSE(off(stop));
    EXPECT_EQ(servos.registers[1][kTorque] + servos.registers[2][kTorque], 0) << stop;
  }
}

TEST_F(ServoRobot, RefusesWhatABoardRefuses) {
  const auto off = robot->set_targets({{{0, 0.1}}}, 100ms);
  ASSERT_FALSE(off);
  ASSERT_TRUE(robot->enable(0b11));
  const auto far = robot->set_targets({{{0, 1.6}}}, 100ms);
  ASSERT_FALSE(far);
  ASSERT_TRUE(robot->set_limits(0b1, {.ramp_rad_per_s = 2, .lower_rad = -0.2, .upper_rad = 9e-1}));
  EXPECT_FALSE(robot->set_targets({{{0, -0.3}}}, 100ms));
  EXPECT_TRUE(robot->set_targets({{{0, 0.8}}}, 100ms));
  EXPECT_FALSE(robot->set_targets({{{7, 0}}}, 100ms)) << "there is no such joint";
  EXPECT_FALSE(robot->subscribe(10ms, KZ_TELEMETRY_STATE));
  const auto settings = robot->settings(0);
  ASSERT_TRUE(settings);
  EXPECT_NEAR(settings->limits.ramp_rad_per_s, 2, 1e-9);
  ASSERT_TRUE(robot->stop());
  EXPECT_EQ(servos.registers[1][40], 0);
  EXPECT_FALSE(robot->set_targets({{{0, 0.1}}}, 100ms));
  ASSERT_TRUE(robot->clear());
  EXPECT_TRUE(robot->enable(0b1));
}

TEST_F(ServoRobot, ALostAnswerIsRequestedAgain) {
  ASSERT_TRUE(robot->enable(0b11));
  for (int i = 0; i < 20; ++i) {
    (void)servos.sleep_until(servos.now() + 10ms);
    if (i % 4 == 0) servos.silent[1] = 1;
    if (i % 4 == 2) servos.damaged = 1;
    const auto state = robot->state();
    ASSERT_TRUE(state) << state.error().message;
    EXPECT_EQ(state->status >> 8, 0);
  }
  EXPECT_EQ(board->counts().missing, 0u);
  EXPECT_EQ(board->counts().damaged, 5u);
}

TEST_F(ServoRobot, AServoThatIsGoneSwitchesTheOthersOff) {
  ASSERT_TRUE(robot->enable(0b11));
  servos.silent[2] = 1000;
  std::uint16_t status = 0;
  for (int i = 0; i < 5 && status >> 8 == 0; ++i) {
    (void)servos.sleep_until(servos.now() + 10ms);
    const auto state = robot->state();
    status = state ? state->status : std::uint16_t{KZ_SHUTDOWN_POT << 8};
  }
  EXPECT_EQ(status >> 8, KZ_SHUTDOWN_POT);
  EXPECT_EQ(servos.registers[1][40], 0);
  servos.silent[2] = 0;
  EXPECT_TRUE(robot->clear());
}

TEST_F(ServoRobot, AnOverloadIsAShutdownThatNamesTheJoint) {
  ASSERT_TRUE(robot->enable(0b11));
  servos.error[2] = feetech::kOverloadError;
  (void)servos.sleep_until(servos.now() + 10ms);
  (void)robot->state();
  const auto health = robot->health();
  ASSERT_TRUE(health);
  EXPECT_EQ(health->status >> 8, KZ_SHUTDOWN_OVERLOAD);
  EXPECT_EQ(health->joint, 1);
  EXPECT_NE(robot->describe_fault(health->status).find("(lift)"), std::string::npos)
      << robot->describe_fault(health->status);
  EXPECT_EQ(servos.registers[1][40], 0);
  EXPECT_FALSE(robot->clear()) << "its cause is still there";
  servos.error[2] = 0;
  EXPECT_TRUE(robot->clear());
}

// A board over two servos that gets raw frames.
struct Framed : testing::Test {
  Framed() {
    servos.add(1, 2048);
    servos.add(2, 1000);
    board.emplace(BusBoard::open(servos, servos, two_joints()).value());
  }
  std::vector<u8> request(u8 type, const std::vector<u8>& fields = {},
                          u8 address = KZ_ADDRESS_DEFAULT) {
    std::vector<u8> body{address, type, 7};
    body.insert(body.end(), fields.begin(), fields.end());
    std::array<u8, KZ_FRAME_MAX> wire{};
    const u8 length = kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data());
    board->take(std::span(wire).first(length));
    return board->serve().value().value();
  }
  int torque(int id) { return servos.registers[id][40]; }
  Servos servos;
  std::optional<BusBoard> board;
};

TEST_F(Framed, ARequestThatIsRepeatedIsDoneOnce) {
  const std::vector<u8> both{0, 0, 0, 0b11}, here{0, 0, 0, 0b11, 0, 100, 0, 50, 0, 50};
  request(KZ_TYPE_enable, both);
  int writes = servos.writes;
  request(KZ_TYPE_enable, both);
  EXPECT_EQ(servos.writes, writes);
  const auto first = request(KZ_TYPE_targets, here);
  writes = servos.writes;
  EXPECT_EQ(request(KZ_TYPE_targets, here), first);
  EXPECT_EQ(servos.writes, writes);
  EXPECT_FALSE(board->serve().value());
}

// A servo that has its torque again, by another program or after a lost write: the same frame takes it away.
TEST_F(Framed, WhatSwitchesOffDoesSoEachTime) {
  const struct {
    u8 type;
    std::vector<u8> fields;
    u8 address = KZ_ADDRESS_DEFAULT;
  } all[] = {{KZ_TYPE_stop, {}},
             {KZ_TYPE_stop, {}, KZ_ADDRESS_ALL},
             {KZ_TYPE_enable, {0, 0, 0, 0}},
             {KZ_TYPE_enable, {0, 0, 0, 0}, KZ_ADDRESS_ALL}};
  for (const auto& one : all) {
    for (int press = 0; press < 2; ++press) {
      servos.registers[1][40] = servos.registers[2][40] = 1;
      EXPECT_EQ(request(one.type, one.fields, one.address).empty(), one.address == KZ_ADDRESS_ALL);
      EXPECT_EQ(torque(1) + torque(2), 0) << int(one.type) << ", press " << press;
    }
  }
}

TEST_F(Framed, ARepeatedEnableSwitchesNothingOn) {
  servos.silent[2] = 1000;  // so that it is not switched on
  request(KZ_TYPE_enable, {0, 0, 0, 0b11});
  servos.silent[2] = 0;
  request(KZ_TYPE_enable, {0, 0, 0, 0b11});
  EXPECT_EQ(torque(2), 0);
}

TEST(BusBoard, WhatIsNotThereOrAnotherIsNamed) {
  const auto refusal = [](Servos& servos, std::vector<BusJoint> joints = two_joints()) {
    const auto opened = BusBoard::open(servos, servos, std::move(joints));
    return opened ? std::string("opened") : opened.error().message;
  };
  Servos servos;
  EXPECT_NE(refusal(servos).find("servo 1 (pan), servo 2 (lift) do not answer on the bus"),
            std::string::npos);
  servos.add(1, 2048);
  EXPECT_NE(refusal(servos).find("servo 2 (lift) does not answer"), std::string::npos);
  servos.add(2, 1000);
  servos.set(2, 3, 5);
  EXPECT_NE(refusal(servos).find("servo 2 (lift) on the bus has model number 5"),
            std::string::npos);
  servos.set(2, 3, 777);
  servos.registers[1][33] = 1;
  EXPECT_NE(refusal(servos).find("servo 1 (pan) on the bus is in mode 1"), std::string::npos);
  servos.registers[1][33] = 0;
  // Its acceleration would make each target late.
  servos.registers[2][41] = 50;
  servos.lost[{2, 41}] = {0, 1'000'000};
  EXPECT_NE(refusal(servos).find("servo 2 (lift) on the bus does not accept 0 for its register "
                                 "acceleration"),
            std::string::npos);
  servos.lost.clear();
  auto twice = two_joints();
  twice[1].servo.id = 1;
  EXPECT_NE(refusal(servos, twice).find("the id 1 twice"), std::string::npos);
  EXPECT_NE(refusal(servos, {}).find("1 to 18 joints"), std::string::npos);
  EXPECT_EQ(refusal(servos), "opened");
}

TEST(BusBoard, ARangeThatWrapsOrIsAnotherRobotsIsRefusedBeforeAnythingMoves) {
  Servos servos;
  servos.add(1, 2048);
  servos.add(2, 1000);
  auto wrapped = two_joints();
  wrapped[0].servo.zero = 4000;
  const auto refused = BusBoard::open(servos, servos, wrapped);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find(
                "servo 1 (pan): in bus.json, its range of -86 to 86 degrees corresponds to "
                "positions 3022 to 4978, but the servo has positions 0 to 4095"),
            std::string::npos)
      << refused.error().message;
  servos.add(1, 3500);  // 128 degrees by bus.json
  const auto beyond = BusBoard::open(servos, servos, two_joints());
  ASSERT_FALSE(beyond);
  EXPECT_NE(beyond.error().message.find(
                "is at 128 degrees according to bus.json, outside its range of -86 to 86"),
            std::string::npos)
      << beyond.error().message;
  EXPECT_EQ(servos.registers[1][40], 0) << "its torque is off";
}

}  // namespace
}  // namespace kaz::host
