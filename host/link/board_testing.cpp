// Ticks, bytes and motors of the test board.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/board_testing.h"

#include <algorithm>
#include <cmath>

#include "shared/base/angle.hpp"

namespace kaz::host {

namespace {

constexpr double kTickSeconds = 1e-3;

struct Wiring {
  int pwm, port, bit, analog, sign;
  double pot_centre_rad;
};
constexpr Wiring kWiring[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  {pwm, port, bit, (mux)*KZ_MUX_INPUTS + (input), sign, (pot_centre)*0.1 * kDegree},
#include "shared/board/joints.def"
#undef KZ_JOINT
};

// splitmix64 (Vigna), as a number in 0..1.
double next_random(std::uint64_t& state) {
  std::uint64_t z = state += 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

TestBoard::TestBoard(const Options& options)
    : options_(options), random_(options.seed), servo_(std::make_unique<kz_servo>()) {
  reset();
  run_until(options.tick_offset + std::chrono::microseconds(10370));
}

void TestBoard::reset() {
  kz_startup startup;
  kz_startup_nominal(&startup);
  kz_servo_init(servo_.get(), &startup, &output_);
  reset_at_ = next_tick_;
  to_board_.clear();
  to_host_.clear();
  frame_from_board_.clear();
  line_to_board_free_ = line_to_host_free_ = now_;
}

Time TestBoard::start_of_tick(std::uint32_t tick) const {
  return options_.tick_offset +
         from_seconds(tick * kTickSeconds * (1 + options_.crystal_ppm * 1e-6));
}

Time TestBoard::random_delay(Time max_delay) {
  return max_delay == Time::zero() ? max_delay
                                   : from_seconds(seconds(max_delay) * next_random(random_));
}

Result<void> TestBoard::sleep_until(Time t) {
  run_until(t);
  return {};
}

Result<void> TestBoard::write(std::span<const std::uint8_t> bytes) {
  if (link_failure) return tl::unexpected(*link_failure);
  Bytes sent(bytes.begin(), bytes.end());
  if (to_board) sent = to_board(sent);
  line_to_board_free_ =
      std::max(line_to_board_free_, now_ + random_delay(options_.latency_to_board));
  for (const std::uint8_t byte : sent) {
    line_to_board_free_ += kByte;
    to_board_.push_back({line_to_board_free_, byte});
  }
  return {};
}

Result<std::size_t> TestBoard::read(std::span<std::uint8_t> bytes, Time deadline) {
  if (link_failure) return tl::unexpected(*link_failure);
  while (to_host_.empty() || to_host_.front().at > now_) {
    if (now_ >= deadline) return 0;
    const Time next_tick = start_of_tick(next_tick_);
    const Time next_byte = to_host_.empty() ? next_tick : to_host_.front().at;
    run_until(std::min({deadline, std::max(next_tick, now_), std::max(next_byte, now_)}));
  }
  std::size_t count = 0;
  while (count < bytes.size() && !to_host_.empty() && to_host_.front().at <= now_) {
    bytes[count++] = to_host_.front().value;
    to_host_.pop_front();
  }
  return count;
}

void TestBoard::inject(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) to_host_.push_back({now_, byte});
}

void TestBoard::run_until(Time t) {
  while (start_of_tick(next_tick_) <= t) {
    const Time start = start_of_tick(next_tick_);
    run_tick(start);
    if (after_tick) after_tick(start);
  }
  now_ = std::max(now_, t);
}

void TestBoard::run_tick(Time start) {
  move_joints();
  past_.push_back(angle_);
  motors_on_ = output_.p4 & KZ_P4_ENABLE;
  if (!mute) transmit(start);

  kz_tick_input input{};
  input.tick = next_tick_++ - reset_at_;
  input.tx_room = 64;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) input.analog[kWiring[j].analog] = pot_code(j);
  input.analog[KZ_ANALOG_SUPPLY] =
      static_cast<u16>(std::lround(supply_volts.value_or(10) * 1000 / 15));
  input.analog[KZ_ANALOG_REFERENCE] = 512;
  input.analog[KZ_ANALOG_YAW_RATE] = inertial[0];
  input.analog[KZ_ANALOG_FORWARD_FORCE] = inertial[1];
  input.analog[KZ_ANALOG_LEFT_FORCE] = inertial[2];
  while (!to_board_.empty() && to_board_.front().at <= start && input.rx_count < KZ_RX_PER_TICK) {
    input.rx[input.rx_count++] = to_board_.front().value;
    to_board_.pop_front();
  }
  if (mute) input.rx_count = 0;
  kz_tick(servo_.get(), &input, &output_);
}

// What the previous tick queued leaves at the start of this one.
void TestBoard::transmit(Time start) {
  const Time delay = random_delay(options_.latency_to_host);
  const auto push = [&](std::uint8_t byte) {
    line_to_host_free_ = std::max(line_to_host_free_, start) + kByte;
    const Time arrival = line_to_host_free_ + delay;
    to_host_.push_back({to_host_.empty() ? arrival : std::max(arrival, to_host_.back().at), byte});
  };
  for (std::size_t i = 0; i < output_.tx_count; ++i) {
    if (!to_host) {
      push(output_.tx[i]);
      continue;
    }
    frame_from_board_.push_back(output_.tx[i]);
    if (output_.tx[i] == 0 && frame_from_board_.size() > 1) {
      for (const std::uint8_t byte : to_host(frame_from_board_)) push(byte);
      frame_from_board_.clear();
    }
  }
}

void TestBoard::move_joints() {
  // At 10 V: torque at stall before friction Nm, back-EMF Nms/rad, Coulomb friction Nm; rotor and a
  // head on top, kg m^2.
  constexpr double kStall = 2.288, kBack = 0.1885, kFriction = 0.128, kInertia = 5e-4 + 2e-4;
  constexpr double kResistance = kBack + kInertia / kTickSeconds;
  const std::uint8_t ports[8] = {0, 0, 0, output_.p3, output_.p4, output_.p5, output_.p6, 0};
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const Wiring& wiring = kWiring[j];
    const int counts = wiring.pwm < 16 ? output_.pw[wiring.pwm] : output_.tmo[wiring.pwm - 16];
    const bool forward = ports[wiring.port] >> wiring.bit & 1;
    const double duty = motors_on_ ? counts / 256.0 * (forward ? 1 : -1) * wiring.sign : 0;
    const double free = (kStall * duty + kInertia / kTickSeconds * speed_[j]) / kResistance;
    speed_[j] = std::copysign(std::max(std::abs(free) - kFriction / kResistance, 0.0), free);
    angle_[j] += speed_[j] * kTickSeconds;
  }
}

std::uint16_t TestBoard::pot_code(std::size_t joint) const {
  const Wiring& wiring = kWiring[joint];
  const double turned = wiring.sign * (angle_[joint] - wiring.pot_centre_rad);
  return static_cast<std::uint16_t>(std::clamp(
      std::floor(512.5 + turned / (190 * kDegree) * KZ_POT_CODES), 0.0, KZ_POT_CODES - 1.0));
}

TestBoard::Angles TestBoard::angles_at(Time t) const {
  const double tick =
      seconds(t - options_.tick_offset) / kTickSeconds / (1 + options_.crystal_ppm * 1e-6);
  const double index = std::clamp(tick, 0.0, static_cast<double>(past_.size() - 1));
  const auto before = static_cast<std::size_t>(index);
  const auto after = std::min(before + 1, past_.size() - 1);
  Angles angle;
  for (std::size_t j = 0; j < angle.size(); ++j) {
    angle[j] = past_[before][j] +
               (index - static_cast<double>(before)) * (past_[after][j] - past_[before][j]);
  }
  return angle;
}

}  // namespace kaz::host
