// A virtual servo board on a bench: the chip, its line, potentiometers and freely turning motors.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/virtual_bench.h"

#include <algorithm>
#include <cmath>

#include "sim/board/potentiometer.h"
#include "sim/runtime/time.h"

namespace kaz::lockstep {
namespace {

using sim::States;

// A byte every 87 us: fine enough for the times that the cases measure.
constexpr States kStep = KZ_STATES_PER_TICK / 8;
constexpr double kStepSeconds = static_cast<double>(kStep) / KZ_CLOCK_HZ;

// S9204 at 10 V (design, section 4): no-load speed 11.5 rad/s; it gets there in some 30 ms.
constexpr double kNoLoadSpeed = 11.5;
constexpr double kTimeConstant = 0.03;
constexpr double kLeastDrive = 0.06;  // Coulomb friction, as a share of the stall torque
constexpr double kEndStop = 1.63;     // of the potentiometer's track, rad around its centre

constexpr double kSupplyVolts = 10.0;
constexpr double kDriverCelsius = 25.0;

struct Wiring {
  int pwm, port, bit, mux, input, sign, pot_centre_decideg;
};
constexpr Wiring kWiring[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  {pwm, port, bit, mux, input, sign, pot_centre},
#include "shared/board/joints.def"
#undef KZ_JOINT
};

const Wiring& wiring(int joint) {
  return kWiring[static_cast<std::size_t>(joint)];
}

int port_level(const sim::PinLevels& pins, int port) {
  return port == 3 ? pins.p3 : port == 4 ? pins.p4 : port == 5 ? pins.p5 : pins.p6;
}

}  // namespace

VirtualBench::VirtualBench(std::unique_ptr<sim::Mcu> mcu) : mcu_(std::move(mcu)) {
  mcu_->set_analog(
      [this](int channel, const sim::PinLevels& levels, States) { return share(channel, levels); });
}

double VirtualBench::share(int channel, const sim::PinLevels& levels) const {
  if (channel < 0 || channel >= KZ_MUXES) return 0;
  const int input = channel * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
  if (const auto& code = held_[static_cast<std::size_t>(input)]) {
    return (*code + 0.5) / KZ_POT_CODES;
  }
  if (input == KZ_ANALOG_SUPPLY) return kSupplyVolts * 1000 / KZ_SUPPLY_FULL_MV;
  if (input == KZ_ANALOG_REFERENCE) return 0.5;
  if (input == KZ_ANALOG_TEMPERATURE) return kDriverCelsius * 10 / KZ_TEMPERATURE_FULL_DC;
  for (int joint = 0; joint < KZ_JOINTS; ++joint) {
    if (wiring(joint).mux * KZ_MUX_INPUTS + wiring(joint).input == input) {
      return sim::pot_ratio(joint, joints_[static_cast<std::size_t>(joint)].angle);
    }
  }
  return 0;
}

std::string VirtualBench::name() const {
  const std::string emulator = mcu_->emulator_engine();
  return "virtual board (" + mcu_->name() + (emulator.empty() ? "" : ", " + emulator) + ")";
}

Time VirtualBench::now() const {
  return sim::time_of(now_);
}

Time VirtualBench::byte_time() const {
  return sim::time_of(KZ_STATES_PER_BYTE);
}

Result<void> VirtualBench::step() {
  now_ += kStep;
  const auto arrived = line_.take_for_board(now_);
  if (!power_) {
    off_ += kStep;
    return {};
  }
  for (sim::SerialByte byte : arrived) {
    byte.at = std::max(byte.at - off_, mcu_->now());
    mcu_->receive(byte);
  }
  if (auto ran = mcu_->run_until(now_ - off_); !ran) return ran;
  auto sent = mcu_->take_transmitted();
  for (sim::SerialByte& byte : sent) byte.at += off_;
  line_.from_board(sent);
  for (int j = 0; j < KZ_JOINTS; ++j) {
    Joint& joint = joints_[static_cast<std::size_t>(j)];
    if (joint.blocked) {
      joint.speed = 0;
      continue;
    }
    const double force = drive(j);
    const double rubbing = std::copysign(std::min(kLeastDrive, std::abs(force)), force);
    joint.speed += ((force - rubbing) * kNoLoadSpeed - joint.speed) * kStepSeconds / kTimeConstant;
    joint.angle += joint.speed * kStepSeconds;
    const double centre = wiring(j).pot_centre_decideg * 3.14159265358979 / 1800;
    const double inside = std::clamp(joint.angle, centre - kEndStop, centre + kEndStop);
    if (inside != joint.angle) joint.speed = 0;
    joint.angle = inside;
  }
  return {};
}

Result<void> VirtualBench::sleep_until(Time t) {
  while (now() < t) {
    if (auto stepped = step(); !stepped) return stepped;
  }
  return {};
}

Result<void> VirtualBench::write(std::span<const std::uint8_t> bytes) {
  line_.write(bytes, now_);
  return {};
}

Result<std::size_t> VirtualBench::read(std::span<std::uint8_t> bytes, Time deadline) {
  while (true) {
    const std::size_t count = line_.read(bytes, now_);
    if (count > 0 || now() >= deadline) return count;
    KAZ_TRY(step());
  }
}

void VirtualBench::restore() {
  held_.fill(std::nullopt);
  joints_.fill({});
  if (!power_) set_power(true);
}

void VirtualBench::set_power(bool on) {
  if (on && !power_) mcu_->power_cycle();
  power_ = on;
}

void VirtualBench::set_analog(int input, std::optional<int> code) {
  held_[static_cast<std::size_t>(input)] = code;
}

void VirtualBench::place_joint(int joint, double angle_rad) {
  joints_[static_cast<std::size_t>(joint)].angle = angle_rad;
  joints_[static_cast<std::size_t>(joint)].speed = 0;
}

void VirtualBench::block_joint(int joint, bool blocked) {
  joints_[static_cast<std::size_t>(joint)].blocked = blocked;
}

void VirtualBench::write_damaged(std::span<const std::uint8_t> bytes) {
  line_.write_garbled(bytes, now_);
}

double VirtualBench::drive(int joint) const {
  const sim::PinLevels& pins = mcu_->pins();
  if (!power_ || !(pins.p4 & KZ_P4_ENABLE)) return 0;
  const Wiring& wire = wiring(joint);
  const auto pwm = static_cast<std::size_t>(wire.pwm);
  const int counts = pwm < 16 ? pins.pw[pwm] : pins.tmo[pwm - 16];
  const bool forward = (port_level(pins, wire.port) >> wire.bit & 1) != 0;
  return (forward ? counts : -counts) * wire.sign / 255.0;
}

double VirtualBench::angle_rad(int joint) const {
  return joints_[static_cast<std::size_t>(joint)].angle;
}

}  // namespace kaz::lockstep
