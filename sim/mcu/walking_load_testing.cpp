// The walking load: a host's requests, and motors without inertia.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/walking_load_testing.h"

#include <algorithm>
#include <cmath>

#include "shared/board/table.h"
#include "shared/protocol/frame.h"
#include "shared/protocol/messages.h"

namespace kaz::sim {
namespace {

struct Wiring {
  int pwm, port, bit;
};

constexpr std::array<Wiring, KZ_JOINTS> kWiring{{
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) {pwm, port, bit},
#include "shared/board/joints.def"
#undef KZ_JOINT
}};

constexpr std::int64_t kStart_ms = 100, kEnable_ms = 110, kWalking_ms = 600;
constexpr int kStep_ms = 10;
constexpr int kStatesAtMs = 7;  // the targets have been received and their reply sent
// A gait of one step per second, joints a radian of phase apart, amplitude 0.3 rad.
constexpr double kPhasePerStep = 0.06;
constexpr int kAmplitude = 3000;
// No-load speed of the servos, 60 degrees in 0.2 s, as a fraction of the potentiometer's 190 degrees.
constexpr double kFullSpeedPerMs = 300.0 / 190 / 1000;

std::uint8_t port_level(const PinLevels& pins, int port) {
  return port == 3 ? pins.p3 : port == 4 ? pins.p4 : port == 5 ? pins.p5 : pins.p6;
}

}  // namespace

WalkingLoad::WalkingLoad(Mcu& mcu) : mcu_(mcu) {
  for (const kz_board_joint& joint : kz_board_joints) inputs_[joint.analog] = 0.5;
  inputs_[KZ_ANALOG_SUPPLY] = 10'000.0 / KZ_SUPPLY_FULL_MV;
  inputs_[KZ_ANALOG_REFERENCE] = 0.5;
  inputs_[KZ_ANALOG_TEMPERATURE] = 250.0 / KZ_TEMPERATURE_FULL_DC;
  mcu_.set_analog([this](int channel, const PinLevels& levels, States) {
    if (channel >= KZ_MUXES) return 0.0;
    return inputs_[static_cast<unsigned>(channel) * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK)];
  });
}

Result<void> WalkingLoad::start() {
  while (milliseconds_ < kWalking_ms) {
    if (auto done = millisecond(); !done) return done;
  }
  return {};
}

Result<void> WalkingLoad::millisecond() {
  if (milliseconds_ == kStart_ms) {
    const kz_enable request{(1u << KZ_JOINTS) - 1};
    std::array<std::uint8_t, KZ_PAYLOAD_MAX> fields{};
    send(KZ_TYPE_enable, fields.data(), kz_pack_enable(&request, fields.data()));
  } else if (milliseconds_ >= kEnable_ms) {
    if (milliseconds_ % kStep_ms == 0) send_targets();
    if (milliseconds_ % kStep_ms == kStatesAtMs) send(KZ_TYPE_state, nullptr, 0);
  }
  ++milliseconds_;
  if (auto ran = mcu_.run_until(mcu_.now() + KZ_STATES_PER_TICK); !ran) return ran;
  bytes_from_board_ += static_cast<std::int64_t>(mcu_.take_transmitted().size());
  move_joints();
  return {};
}

void WalkingLoad::send(std::uint8_t type, const std::uint8_t* fields, std::uint8_t size) {
  std::array<std::uint8_t, KZ_BODY_MAX> body{KZ_ADDRESS_DEFAULT, type, ++sequence_};
  std::copy_n(fields, size, body.begin() + KZ_HEADER_SIZE);
  std::array<std::uint8_t, KZ_FRAME_MAX> wire{};
  const int length =
      kz_frame_encode(body.data(), static_cast<u8>(KZ_HEADER_SIZE + size), wire.data());
  wire_free_ = std::max(wire_free_, mcu_.now());
  for (int i = 0; i < length; ++i) {
    wire_free_ += KZ_STATES_PER_BYTE;
    mcu_.receive({wire[static_cast<std::size_t>(i)], wire_free_, false});
  }
  bytes_to_board_ += length;
}

void WalkingLoad::send_targets() {
  const double phase = kPhasePerStep * static_cast<double>(milliseconds_) / kStep_ms;
  kz_targets request{};
  request.mask = (1u << KZ_JOINTS) - 1;
  request.duration_ms = kStep_ms;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const kz_board_joint& joint = kz_board_joints[j];
    const int middle = (joint.lower + joint.upper) / 2;
    const int swing = std::min(kAmplitude, (joint.upper - joint.lower) / 2);
    targets_[static_cast<std::size_t>(j)] = request.angle[j] =
        static_cast<s16>(middle + std::lround(swing * std::sin(phase + j)));
  }
  std::array<std::uint8_t, KZ_PAYLOAD_MAX> fields{};
  send(KZ_TYPE_targets, fields.data(), kz_pack_targets(&request, fields.data()));
}

void WalkingLoad::move_joints() {
  const PinLevels& pins = mcu_.pins();
  if (!(pins.p4 & KZ_P4_ENABLE)) return;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const auto pwm = static_cast<std::size_t>(kWiring[j].pwm);
    const double duty = (pwm < 16 ? pins.pw[pwm] : pins.tmo[pwm - 16]) / 256.0;
    const bool forward = (port_level(pins, kWiring[j].port) >> kWiring[j].bit & 1) != 0;
    double& share = inputs_[kz_board_joints[j].analog];
    share = std::clamp(share + (forward ? duty : -duty) * kFullSpeedPerMs, 0.0, 1.0);
  }
}

double WalkingLoad::error(int joint) const {
  const kz_board_joint& wire = kz_board_joints[joint];
  const double code = inputs_[wire.analog] * KZ_POT_CODES;
  const int angle = kz_pot_angle(&wire, static_cast<u16>(std::min(code, KZ_POT_CODES - 1.0)));
  return std::abs(angle - targets_[static_cast<std::size_t>(joint)]) /
         static_cast<double>(KZ_ANGLE_PER_RAD);
}

}  // namespace kaz::sim
