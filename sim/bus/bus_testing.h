// For tests: a host on a virtual bus, and buses with servos whose shafts turn freely.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shared/dynamixel/packet.h"
#include "shared/feetech/packet.h"
#include "sim/bus/virtual_bus.h"

namespace kaz::sim::test {

using Bytes = std::vector<std::uint8_t>;
using feetech::Instruction;
using feetech::Packet;

// World whose joints have no mass and no friction. Each joint turns at 5 rad/s times the duty of the joint's
// drive.
class ShaftWorld final : public World {
 public:
  explicit ShaftWorld(std::size_t joints) : joints_(joints) {
    for (std::size_t i = 0; i < joints; ++i) names_.push_back("joint" + std::to_string(i + 1));
  }
  double step_s() const override { return 0.001; }
  double time_s() const override { return time_; }
  void step(std::span<const MotorDrive> drives, double) override {
    time_ += step_s();
    drives_.assign(drives.begin(), drives.end());
    current_ = 0;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      current_ += drives[i].duty * joints_[i].current;
      joints_[i].velocity = drives[i].powered ? 5 * drives[i].duty : 0;
      joints_[i].angle += step_s() * joints_[i].velocity;
    }
  }
  std::span<const JointState> joints() const override { return joints_; }
  std::span<const std::string> joint_order() const override { return names_; }
  double supply_current_a() const override { return current_; }
  const ImuState& imu() const override { return imu_; }
  const Scene& scene() const override { return scene_; }
  ScenePose pose() const override { return {}; }
  int head_frame() const override { return -1; }
  Eigen::Isometry3d link_pose(const std::string&) const override {
    return Eigen::Isometry3d::Identity();
  }
  Result<Eigen::Vector3d> object_position(const std::string&) const override {
    return fail(Fault::usage, "no such object");
  }
  double largest_joint_gap_m() const override { return 0; }
  std::string dynamics() const override { return "none"; }

  std::vector<JointState> joints_;
  std::vector<MotorDrive> drives_;  // drives in the last step

 private:
  std::vector<std::string> names_;
  double time_ = 0, current_ = 0;
  ImuState imu_;
  Scene scene_;
};

// Packet functions of each protocol. These structs are template arguments of HostOnBus.
struct FeetechWire {
  using Packet = feetech::Packet;
  using Reader = feetech::PacketReader;
  static constexpr const char* kModel = "sts3215";
  static Bytes wire_of(const Packet& packet) { return feetech::wire_of(packet); }
  static Packet read(int id, int address, int length) {
    return feetech::request(
        static_cast<std::uint8_t>(id), feetech::Instruction::read,
        {static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(length)});
  }
  static Packet write(int id, int address, const Bytes& data) {
    Bytes parameters{static_cast<std::uint8_t>(address)};
    parameters.insert(parameters.end(), data.begin(), data.end());
    return feetech::request(static_cast<std::uint8_t>(id), feetech::Instruction::write, parameters);
  }
  static int error(const Packet& packet) { return packet.code; }
};
struct DynamixelWire {
  using Packet = dynamixel::Packet;
  using Reader = dynamixel::PacketReader;
  static constexpr const char* kModel = "xl330-m288";
  static Bytes wire_of(const Packet& packet) { return dynamixel::wire_of(packet); }
  static Packet read(int id, int address, int length) {
    const auto at = static_cast<std::size_t>(address), count = static_cast<std::size_t>(length);
    return dynamixel::request(
        static_cast<std::uint8_t>(id), dynamixel::Instruction::read,
        {dynamixel::low(at), dynamixel::high(at), dynamixel::low(count), dynamixel::high(count)});
  }
  static Packet write(int id, int address, const Bytes& data) {
    const auto at = static_cast<std::size_t>(address);
    Bytes parameters{dynamixel::low(at), dynamixel::high(at)};
    parameters.insert(parameters.end(), data.begin(), data.end());
    return dynamixel::request(static_cast<std::uint8_t>(id), dynamixel::Instruction::write,
                              parameters);
  }
  static int error(const Packet& packet) { return packet.error; }
};

// Returns the bytes of a request that writes a register. The request uses the protocol of `model`.
inline Bytes write_request(const servo_bus::Model& model, int id, const std::string& name,
                           int value) {
  const servo_bus::Register& reg = *model.find(name);
  const Bytes data = servo_bus::encode(model, reg, value);
  return model.protocol == servo_bus::Protocol::feetech
             ? feetech::wire_of(FeetechWire::write(id, reg.address, data))
             : dynamixel::wire_of(DynamixelWire::write(id, reg.address, data));
}

// Returns a bus at 1 Mbaud with servos of the given ids. `alter` may change the bus's file.
inline std::unique_ptr<VirtualBus> bus_of(
    const std::vector<int>& ids, const std::string& model = "sts3215",
    const std::function<void(servo_bus::BusFile&)>& alter = nullptr) {
  static const std::map<std::string, double> kVolts{
      {"sts3215", 7.4}, {"scs0009", 6}, {"xl430-w250", 11.1}, {"xm430-w350", 12}};
  servo_bus::BusFile file;
  file.supply_volts = kVolts.contains(model) ? kVolts.at(model) : 5;
  file.baud = 1'000'000;
  auto world = std::make_unique<ShaftWorld>(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const servo_bus::Model* found = servo_bus::find_model(model);
    file.servos.push_back({world->joint_order()[i], ids[i], found, found->steps / 2.0, false});
  }
  if (alter) alter(file);
  auto bus = VirtualBus::create(std::move(world), file);
  EXPECT_TRUE(bus) << bus.error().message;
  return bus ? std::move(*bus) : nullptr;
}

// A host that sends requests and collects the answers.
template <class Wire>
class HostOnBus {
 public:
  using Packet = typename Wire::Packet;
  explicit HostOnBus(VirtualBus& bus) : bus_(&bus) {}

  // Sends a request and returns the answers that arrive within `patience` after the request's last byte.
  std::vector<Packet> send(const Bytes& wire, Time patience = std::chrono::milliseconds(3)) {
    const Time sent = bus_->write(wire);
    bus_->advance(sent + patience);
    std::vector<Packet> answers;
    for (; !bus_->received().empty(); bus_->received().pop_front()) {
      last_byte_ = bus_->received().front().at;
      if (reader_.take(bus_->received().front().byte) == Wire::Reader::Event::packet)
        answers.push_back(reader_.packet());
    }
    reader_.reset();
    return answers;
  }
  std::vector<Packet> send(const Packet& packet, Time patience = std::chrono::milliseconds(3)) {
    return send(Wire::wire_of(packet), patience);
  }
  // Reads registers and returns the data of the answer. Returns nullopt unless exactly one answer arrives and
  // the answer has this id.
  std::optional<Bytes> read(int id, int address, int length) {
    const auto answers = send(Wire::read(id, address, length));
    if (answers.size() != 1 || answers[0].id != id) return std::nullopt;
    return answers[0].parameters;
  }
  // Writes registers and returns the error byte of the answer. Returns -1 unless exactly one answer arrives
  // and the answer has this id.
  int write(int id, int address, const Bytes& data) {
    const auto answers = send(Wire::write(id, address, data));
    return answers.size() == 1 && answers[0].id == id ? Wire::error(answers[0]) : -1;
  }
  // Returns the value of a register, or -100000 if there is no answer.
  int get(int id, const std::string& name) {
    const servo_bus::Register& reg = *model_.find(name);
    const auto bytes = read(id, reg.address, reg.size);
    return bytes ? servo_bus::decode(model_, reg, *bytes) : -100000;
  }
  int set_with_error(int id, const std::string& name, int value) {
    const servo_bus::Register& reg = *model_.find(name);
    return write(id, reg.address, servo_bus::encode(model_, reg, value));
  }
  // Writes a register. Returns true if the answer has no error bit.
  bool set(int id, const std::string& name, int value) {
    return set_with_error(id, name, value) == 0;
  }
  // Selects the model whose registers get() and set() use.
  void use(const std::string& model) { model_ = *servo_bus::find_model(model); }
  const PacketCounts& counts() const { return reader_.counts(); }
  Time last_byte() const { return last_byte_; }

 private:
  VirtualBus* bus_;
  servo_bus::Model model_ = *servo_bus::find_model(Wire::kModel);
  typename Wire::Reader reader_;
  Time last_byte_{};
};
using BusHost = HostOnBus<FeetechWire>;
using DynamixelHost = HostOnBus<DynamixelWire>;

}  // namespace kaz::sim::test
