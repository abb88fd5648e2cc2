// For tests: a host at a virtual bus, and buses of servos on shafts that nothing turns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "shared/feetech/packet.h"
#include "sim/bus/virtual_bus.h"

namespace kaz::sim::test {

using Bytes = std::vector<std::uint8_t>;
using feetech::Instruction;
using feetech::Packet;

// Joints that turn at 5 rad/s times the duty of their drive, without mass and friction.
class ShaftWorld final : public World {
 public:
  explicit ShaftWorld(std::size_t joints) : joints_(joints) {
    for (std::size_t i = 0; i < joints; ++i) names_.push_back("joint" + std::to_string(i + 1));
  }
  double step_s() const override { return 0.001; }
  double time_s() const override { return time_; }
  void step(std::span<const MotorDrive> drives, double) override {
    time_ += step_s();
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      joints_[i].velocity = drives[i].powered ? 5 * drives[i].duty : 0;
      joints_[i].angle += step_s() * joints_[i].velocity;
    }
  }
  std::span<const JointState> joints() const override { return joints_; }
  std::span<const std::string> joint_order() const override { return names_; }
  double supply_current_a() const override { return 0; }
  const ImuState& imu() const override { return imu_; }
  const Scene& scene() const override { return scene_; }
  ScenePose pose() const override { return {}; }
  int head_frame() const override { return -1; }
  Eigen::Isometry3d link_pose(const std::string&) const override {
    return Eigen::Isometry3d::Identity();
  }
  Result<Eigen::Vector3d> object_position(const std::string&) const override {
    return fail(Fault::usage, "there is none");
  }
  double largest_joint_gap_m() const override { return 0; }
  std::string dynamics() const override { return "none"; }

  std::vector<JointState> joints_;

 private:
  std::vector<std::string> names_;
  double time_ = 0;
  ImuState imu_;
  Scene scene_;
};

// Servos with these ids, on shafts.
inline std::unique_ptr<VirtualBus> bus_of(const std::vector<int>& ids,
                                          const std::string& model = "sts3215") {
  feetech::BusFile file;
  file.supply_volts = model == "sts3215" ? 7.4 : 6;
  auto world = std::make_unique<ShaftWorld>(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const feetech::Model* found = feetech::find_model(model);
    file.servos.push_back({world->joint_order()[i], ids[i], found, found->steps / 2.0, false});
  }
  auto bus = VirtualBus::create(std::move(world), file);
  EXPECT_TRUE(bus) << bus.error().message;
  return bus ? std::move(*bus) : nullptr;
}

// A host: sends requests and collects what comes back.
class BusHost {
 public:
  explicit BusHost(VirtualBus& bus) : bus_(&bus) {}

  // Answers to a request that come within `patience` after its last byte.
  std::vector<Packet> send(const Bytes& wire, Time patience = std::chrono::milliseconds(3)) {
    const Time sent = bus_->write(wire);
    bus_->advance(sent + patience);
    std::vector<Packet> answers;
    for (; !bus_->received().empty(); bus_->received().pop_front()) {
      last_byte_ = bus_->received().front().at;
      if (reader_.take(bus_->received().front().byte) == feetech::PacketReader::Event::packet)
        answers.push_back(reader_.packet());
    }
    reader_.reset();
    return answers;
  }
  std::vector<Packet> send(const Packet& packet, Time patience = std::chrono::milliseconds(3)) {
    return send(feetech::wire_of(packet), patience);
  }
  // The single answer's data; nothing if there is no answer, or another one.
  std::optional<Bytes> read(int id, int address, int length) {
    const auto answers = send(
        feetech::request(static_cast<std::uint8_t>(id), Instruction::read,
                         {static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(length)}));
    if (answers.size() != 1 || answers[0].id != id) return std::nullopt;
    return answers[0].parameters;
  }
  // The value of a register; -100000 if there is no answer.
  int get(int id, const std::string& name) {
    const feetech::Model& model = model_;
    const feetech::Register& reg = *model.find(name);
    const auto bytes = read(id, reg.address, reg.size);
    return bytes ? feetech::decode(model, reg, *bytes) : -100000;
  }
  // True if it was answered without an error bit.
  bool set(int id, const std::string& name, int value) {
    const feetech::Model& model = model_;
    const feetech::Register& reg = *model.find(name);
    Bytes parameters{reg.address};
    for (const std::uint8_t byte : feetech::encode(model, reg, value)) parameters.push_back(byte);
    const auto answers =
        send(feetech::request(static_cast<std::uint8_t>(id), Instruction::write, parameters));
    return answers.size() == 1 && answers[0].id == id && answers[0].code == 0;
  }
  void use(const std::string& model) { model_ = *feetech::find_model(model); }
  const feetech::PacketReader::Counts& counts() const { return reader_.counts(); }
  Time last_byte() const { return last_byte_; }

 private:
  VirtualBus* bus_;
  feetech::Model model_ = *feetech::find_model("sts3215");
  feetech::PacketReader reader_;
  Time last_byte_{};
};

}  // namespace kaz::sim::test
