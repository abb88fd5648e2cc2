// A servo bus in simulated time.
// SPDX-License-Identifier: Apache-2.0
#include "sim/bus/virtual_bus.h"

#include <algorithm>

namespace kaz::sim {

Result<std::unique_ptr<VirtualBus>> VirtualBus::create(std::unique_ptr<World> world,
                                                       const servo_bus::BusFile& file) {
  std::vector<Mounted> servos;
  const auto joints = world->joint_order();
  const servo_model::IdentifiedServo* identified = world->servo();
  for (const servo_bus::BusServo& mount : file.servos) {
    const auto joint = std::ranges::find(joints, mount.joint);
    if (joint == joints.end())
      return fail(Fault::usage, "bus.json names the joint `" + mount.joint +
                                    "`, but the robot has no such joint; see the robot's URDF");
    auto servo = VirtualServo::make(*mount.model, mount.id);
    const auto code = std::ranges::find(mount.model->bauds, file.baud);
    if (code != mount.model->bauds.end())
      servo->set_up("baud_rate", static_cast<int>(code - mount.model->bauds.begin()));
    if (identified != nullptr && identified->servo == mount.model->name)
      servo->use_law(std::make_shared<const servo_model::ServoParams>(identified->params()));
    for (const servo_bus::BusSetting& one : file.settings) servo->set_up(one.name, one.value);
    servo->answer_broadcast_ping_in_turn(file.broadcast_ping_in_turn);
    servos.push_back({mount, std::move(servo), static_cast<std::size_t>(joint - joints.begin())});
  }
  for (const std::string& joint : joints) {
    if (std::ranges::none_of(file.servos, [&](const auto& one) { return one.joint == joint; }))
      return fail(Fault::usage,
                  "the joint `" + joint + "` has no servo in bus.json; add a servo for this joint");
  }
  return std::unique_ptr<VirtualBus>(new VirtualBus(std::move(world), file, std::move(servos)));
}

Result<std::unique_ptr<VirtualBus>> VirtualBus::load(const std::string& world_path,
                                                     const std::string& robot_path,
                                                     const WorldOptions& options) {
  const auto file = KAZ_TRY(servo_bus::load_bus_file(robot_path));
  auto world = KAZ_TRY(World::load(world_path, robot_path, options));
  return create(std::move(world), file);
}

VirtualBus::VirtualBus(std::unique_ptr<World> world, const servo_bus::BusFile& file,
                       std::vector<Mounted> servos)
    : world_(std::move(world)),
      servos_(std::move(servos)),
      line_(servos_.size() + 1),
      supplies_{{file.supply_volts}},
      supply_ohm_(file.supply_ohm),
      next_step_(from_seconds(world_->step_s())),
      step_length_(next_step_) {
  for (Mounted& one : servos_) {
    if (!one.mount.supply_volts) continue;
    const auto shared = std::find_if(supplies_.begin() + 1, supplies_.end(), [&](const auto& own) {
      return own.volts == *one.mount.supply_volts;
    });
    one.supply = static_cast<std::size_t>(shared - supplies_.begin());
    if (shared == supplies_.end()) supplies_.push_back({*one.mount.supply_volts});
  }
  set_power(false);
  set_power(true);
}

double VirtualBus::volts_of(const Supply& supply) const {
  return power_ ? std::max(0.0, supply.volts - supply_ohm_ * supply.current_a) : 0;
}

ServoReading VirtualBus::reading_of(const Mounted& one) const {
  const JointState& joint = world_->joints()[one.joint];
  const double sign = one.mount.sign();
  return {.steps = one.mount.steps_at(joint.angle),
          .speed = sign * joint.velocity * one.mount.model->steps_per_rad(),
          .current_a = sign * joint.current,
          .case_celsius = joint.case_celsius,
          .supply_volts = volts_of(supplies_[one.supply])};
}

void VirtualBus::set_power(bool on) {
  power_ = on;
  for (std::size_t i = 0; i < servos_.size(); ++i) {
    servos_[i].servo->set_power(on, reading_of(servos_[i]));
    line_.set_baud(i + 1, static_cast<double>(servos_[i].servo->baud()));
  }
}

void VirtualBus::set_host_baud(long baud) {
  line_.set_baud(0, static_cast<double>(baud));
}

Time VirtualBus::write(std::span<const std::uint8_t> bytes) {
  host_sends_until_ = line_.send(0, bytes, time_);
  return host_sends_until_;
}

void VirtualBus::receive(const HalfDuplexLine::Received& received) {
  if (received.node == 0) {
    if (received.stop_bit) held_.push_back({received.byte, received.at});
    if (held_.size() == kAdapterPacket) hand_over();
    return;
  }
  VirtualServo& servo = *servos_[received.node - 1].servo;
  if (!received.stop_bit) return servo.take_noise(received.at);
  const auto answer = servo.take(received.byte, received.at);
  if (answer) line_.send(received.node, answer->bytes, received.at + answer->delay);
  line_.set_baud(received.node, static_cast<double>(servo.baud()));
}

void VirtualBus::set_adapter_latency(Time latency) {
  adapter_latency_ = latency;
}

// The timer of the adapter runs freely: it ends at multiples of the latency.
void VirtualBus::hand_over() {
  if (held_.empty()) return;
  if (adapter_latency_ > Time::zero() && held_.size() < kAdapterPacket) {
    const Time end = (held_.front().at / adapter_latency_ + 1) * adapter_latency_;
    if (time_ < end) return;
    for (HostByte& byte : held_) byte.at = std::max(byte.at, end);
  }
  received_.insert(received_.end(), held_.begin(), held_.end());
  held_.clear();
}

void VirtualBus::turn_by_hand(std::size_t i, double angle) {
  Mounted& one = servos_[i];
  if (!one.hand_goal) one.hand = world_->joints()[one.joint].angle;
  one.hand_goal = angle;
}

void VirtualBus::take_hands_off() {
  for (Mounted& one : servos_) one.hand_goal.reset();
}

// The motor stands for the hand: a spring and a damper, as strong as it is.
MotorDrive VirtualBus::hand_on(Mounted& one) const {
  constexpr double kSpeed = 4, kStiffness = 10, kDamping = 0.3;  // rad/s, duty for rad and rad/s
  const double most = kSpeed * world_->step_s();
  one.hand += std::clamp(*one.hand_goal - one.hand, -most, most);
  const JointState& joint = world_->joints()[one.joint];
  const double duty = kStiffness * (one.hand - joint.angle) - kDamping * joint.velocity;
  return {.duty = std::clamp(duty, -1.0, 1.0), .powered = true};
}

void VirtualBus::step() {
  std::vector<MotorDrive> drives(world_->joints().size());
  for (Mounted& one : servos_) {
    MotorDrive drive = one.servo->step(reading_of(one), world_->step_s(), next_step_);
    drive.duty *= one.mount.sign();
    if (one.hand_goal && !drive.powered) drive = hand_on(one);
    if (one.supply > 0) drive.supply_volts = volts_of(supplies_[one.supply]);
    drives[one.joint] = drive;
  }
  world_->step(drives, volts());
  measure_supplies(drives);
}

// The bus's supply feeds the motors without an own supply.
void VirtualBus::measure_supplies(const std::vector<MotorDrive>& drives) {
  for (Supply& supply : supplies_) supply.current_a = 0;
  supplies_[0].current_a = world_->supply_current_a();
  for (const Mounted& one : servos_) {
    const MotorDrive& drive = drives[one.joint];
    if (one.supply == 0 || !drive.powered) continue;
    const double current_a =
        std::clamp(drive.duty, -1.0, 1.0) * world_->joints()[one.joint].current;
    supplies_[one.supply].current_a += current_a;
    supplies_[0].current_a -= current_a;
  }
}

void VirtualBus::advance(Time until) {
  while (time_ < until) {
    const Time end = std::min(until, next_step_);
    while (const auto received = line_.next(end)) receive(*received);
    time_ = end;
    hand_over();
    if (end < next_step_) continue;
    step();
    next_step_ += step_length_;
  }
}

}  // namespace kaz::sim
