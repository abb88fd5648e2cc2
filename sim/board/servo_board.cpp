// Multiplexers, potentiometers, motor drivers and supply of the servo board.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/servo_board.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shared/base/profile.hpp"
#include "sim/board/noise_key.h"

namespace kaz::sim {
namespace {

struct Wiring {
  int pwm, port, bit, mux, input, sign;
};

constexpr Wiring kWiring[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  {pwm, port, bit, mux, input, sign},
#include "shared/board/joints.def"
#undef KZ_JOINT
};

constexpr States kMaxTime = States{1} << 50;      // of a saved state: two years
constexpr States kMaxInterval = States{1} << 40;  // between two calls of take_drives(): 16 hours

// The joint whose potentiometer is at an input of a multiplexer; -1: none.
constexpr std::array<int, KZ_ANALOG> joints_by_input() {
  std::array<int, KZ_ANALOG> table{};
  table.fill(-1);
  for (std::size_t j = 0; j < KZ_JOINTS; ++j)
    table[static_cast<std::size_t>(kWiring[j].mux * KZ_MUX_INPUTS + kWiring[j].input)] =
        static_cast<int>(j);
  return table;
}
constexpr auto kJointAtInput = joints_by_input();

std::uint8_t port_level(const PinLevels& pins, int port) {
  switch (port) {
    case 3:
      return pins.p3;
    case 4:
      return pins.p4;
    case 5:
      return pins.p5;
    default:
      return pins.p6;
  }
}

// High counts out of 256, signed by direction and mounting.
int signed_counts(const PinLevels& pins, const Wiring& wire) {
  const auto pwm = static_cast<std::size_t>(wire.pwm);
  const int counts = pwm < 16 ? pins.pw[pwm] : pins.tmo[pwm - 16];
  const bool forward = (port_level(pins, wire.port) >> wire.bit & 1) != 0;
  return (forward ? counts : -counts) * wire.sign;
}

}  // namespace

double duty_of(const PinLevels& pins, std::size_t joint) {
  return signed_counts(pins, kWiring[joint]) / 256.0;
}

ServoBoard::ServoBoard(std::unique_ptr<Mcu> mcu, const ServoBoardOptions& options)
    : mcu_(std::move(mcu)), options_(options), heat_(options.params.driver), pins_(mcu_->pins()) {
  make_sensors();
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) pot_[j] = potentiometers_[j].ratio(0.0);
  mcu_->on_pins(
      [this](States at, const PinLevels& levels) { pins_changed(at + off_time_, levels); });
  mcu_->set_analog([this](int channel, const PinLevels& levels, States at) {
    return analog(channel, levels, at + off_time_);
  });
}

void ServoBoard::make_sensors() {
  for (std::size_t j = 0; j < KZ_JOINTS; ++j)
    potentiometers_[j] = Potentiometer(static_cast<int>(j), options_.params.potentiometer,
                                       options_.sensors, options_.seed);
  if (options_.imu) imu_.emplace(options_.params, options_.sensors, options_.seed);
}

Result<void> ServoBoard::run_until(States until) {
  const ProfileScope chip("chip");
  if (power_) {
    if (auto done = mcu_->run_until(until - off_time_); !done) return done;
    now_ = mcu_->now() + off_time_;
  } else if (until > now_) {
    off_time_ += until - now_;
    now_ = until;
  }
  integrate(std::min(until, now_));
  return {};
}

void ServoBoard::set_joint_angles(std::span<const double, KZ_JOINTS> angles_rad) {
  for (std::size_t i = 0; i < KZ_JOINTS; ++i) {
    if (!pot_faults_[i].stuck) pot_[i] = potentiometers_[i].ratio(angles_rad[i]);
  }
}

void ServoBoard::set_motor_current(double amperes) {
  heat_.advance(static_cast<double>(now_ - heated_to_) / KZ_CLOCK_HZ, motor_current_);
  heated_to_ = now_;
  motor_current_ = amperes;
}

void ServoBoard::set_motion(const ImuMotion& motion) {
  if (imu_) imu_->advance(now_ / KZ_STATES_PER_TICK, motion);
}

template <class A>
void ServoBoard::transfer(A& a) {
  a(power_, now_, off_time_, pot_, pot_faults_, options_.supply_volts, supply_current_,
    supply_change_, motor_current_, heated_to_, heat_, pins_, integrated_from_, integrated_to_,
    enabled_states_, duty_states_);
  if (imu_) a(*imu_);
  a.require(now_ >= 0 && now_ <= kMaxTime && heated_to_ >= 0 && heated_to_ <= now_ &&
                integrated_from_ <= integrated_to_ && now_ - integrated_from_ <= kMaxInterval &&
                integrated_to_ - now_ <= kMaxInterval && enabled_states_ >= 0 &&
                enabled_states_ <= kMaxInterval &&
                std::ranges::all_of(duty_states_,
                                    [](std::int64_t sum) {
                                      return sum >= -256 * kMaxInterval &&
                                             sum <= 256 * kMaxInterval;
                                    }) &&
                off_time_ >= 0 && off_time_ <= now_ &&
                (!power_ || std::abs(mcu_->now() + off_time_ - now_) <= KZ_STATES_PER_TICK),
            "board time");
}

void ServoBoard::save(StateWriter& to) {
  mcu_->save(to);
  transfer(to);
}

void ServoBoard::restore(StateReader& from) {
  mcu_->restore(from);
  transfer(from);
}

std::unique_ptr<const Mcu::Kept> ServoBoard::keep(StateWriter& to) {
  auto kept = mcu_->keep(to);
  transfer(to);
  return kept;
}

void ServoBoard::take(StateReader& from, const Mcu::Kept* kept, std::uint64_t seed) {
  mcu_->take(from, kept);
  transfer(from);
  options_.seed = seed;
  const auto measured = imu_;
  make_sensors();
  if (imu_) imu_->follow(*measured);
}

double ServoBoard::supply_volts() const {
  if (!power_) return 0;
  return std::max(0.0,
                  options_.supply_volts + supply_change_ - options_.supply_ohms * supply_current_);
}

double ServoBoard::noise_free(unsigned input) const {
  switch (input) {
    case KZ_ANALOG_SUPPLY:
      return supply_volts() * 1000.0 / KZ_SUPPLY_FULL_MV;
    case KZ_ANALOG_REFERENCE:
      return 0.5;
    case KZ_ANALOG_TEMPERATURE:
      return driver_celsius() * 10.0 / KZ_TEMPERATURE_FULL_DC;
    default:
      break;
  }
  const int joint = kJointAtInput[input];
  if (joint < 0) return 0.0;
  const auto j = static_cast<std::size_t>(joint);
  return pot_faults_[j].level.value_or(pot_[j]);
}

double ServoBoard::noise_codes(unsigned input) const {
  const SensorParams& params = options_.params;
  const SensorSwitches& sensors = options_.sensors;
  switch (input) {
    case KZ_ANALOG_SUPPLY:
      return sensors.supply ? params.supply.noise_codes : 0.0;
    case KZ_ANALOG_REFERENCE:
      return sensors.reference ? params.reference.noise_codes : 0.0;
    case KZ_ANALOG_TEMPERATURE:
      return sensors.temperature ? params.driver.noise_codes : 0.0;
    default:
      break;
  }
  const int joint = kJointAtInput[input];
  if (joint < 0) return 0.0;  // tied to ground
  return std::hypot(sensors.potentiometer ? params.potentiometer.noise_codes : 0.0,
                    pot_faults_[static_cast<std::size_t>(joint)].noise_codes);
}

double ServoBoard::analog(int channel, const PinLevels& levels, States at) const {
  if (channel >= KZ_MUXES && channel < KZ_MUXES + 3 && imu_) return imu_->ratio(channel - KZ_MUXES);
  if (channel < 0 || channel >= KZ_MUXES) return 0.0;  // grounded
  const unsigned input =
      static_cast<unsigned>(channel) * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
  double ratio = noise_free(input);
  const double sigma = noise_codes(input);
  if (sigma > 0) {
    const auto tick = static_cast<std::uint64_t>(at / KZ_STATES_PER_TICK);
    ratio += sigma / KZ_POT_CODES * keyed_normal(options_.seed, tick, input);
  }
  return ratio > 0 ? std::min(ratio, 1.0) : 0.0;  // also where it is no number
}

void ServoBoard::pins_changed(States at, const PinLevels& levels) {
  PinLevels motor_pins = levels;
  // Multiplexer selects change many times a tick and drive no motor.
  motor_pins.p4 =
      static_cast<std::uint8_t>((levels.p4 & ~KZ_P4_MUX_MASK) | (pins_.p4 & KZ_P4_MUX_MASK));
  if (motor_pins != pins_) integrate(at);
  pins_ = levels;
}

void ServoBoard::integrate(States until) {
  if (until <= integrated_to_) return;
  const States length = until - integrated_to_;
  if (power_ && drivers_enabled()) {
    enabled_states_ += length;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j)
      duty_states_[j] += signed_counts(pins_, kWiring[j]) * length;
  }
  integrated_to_ = until;
}

std::array<MeanDrive, KZ_JOINTS> ServoBoard::take_drives() {
  std::array<MeanDrive, KZ_JOINTS> drives{};
  const States length = integrated_to_ - integrated_from_;
  if (length > 0) {
    const bool powered = 2 * enabled_states_ > length;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      drives[j].duty = static_cast<double>(duty_states_[j]) / (256.0 * static_cast<double>(length));
      drives[j].powered = powered;
    }
  }
  integrated_from_ = integrated_to_;
  enabled_states_ = 0;
  duty_states_.fill(0);
  return drives;
}

void ServoBoard::receive(const SerialByte& byte) {
  if (!power_) return;
  SerialByte at_chip = byte;
  // The last instruction may have run past the step in which the byte arrived.
  at_chip.at = std::max(at_chip.at - off_time_, mcu_->now());
  mcu_->receive(at_chip);
}

std::vector<SerialByte> ServoBoard::take_transmitted() {
  std::vector<SerialByte> bytes = mcu_->take_transmitted();
  if (!power_) bytes.clear();
  for (SerialByte& byte : bytes) byte.at += off_time_;
  return bytes;
}

void ServoBoard::set_power(bool on) {
  if (on == power_) return;
  integrate(now_);
  power_ = on;
  if (on) {
    mcu_->power_cycle();
    pins_ = mcu_->pins();
  } else {
    pins_ = PinLevels{};
  }
}

void ServoBoard::reset() {
  integrate(now_);
  mcu_->reset();
  pins_ = mcu_->pins();
}

}  // namespace kaz::sim
