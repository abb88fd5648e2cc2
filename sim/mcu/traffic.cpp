// Random requests encoded as frames, damaged frames, and random joints.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/traffic.h"

#include <algorithm>

#include "shared/protocol/frame.h"
#include "shared/protocol/messages.h"

namespace kaz::sim {
namespace {

constexpr std::uint32_t kMaxNoise = 200;  // bytes; sometimes longer than any frame

std::vector<std::uint8_t> encode(const std::vector<std::uint8_t>& body) {
  std::vector<std::uint8_t> wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

}  // namespace

std::vector<SerialByte> RandomHost::millisecond(States now) {
  std::vector<SerialByte> bytes;
  if (--phase_left_ms_ <= 0) next_phase();
  if (phase_ == Phase::silent || wire_free_ > now) return bytes;
  if (phase_ != Phase::burst && --pause_ms_ > 0) return bytes;
  pause_ms_ = static_cast<int>(random_.below(20));

  std::vector<std::uint8_t> frame;
  if (phase_ == Phase::faulty) {
    frame = any_frame();
    damage_frame(random_, frame, 0, kMaxNoise);
  } else {
    frame = request();
  }
  ++frames_;
  // Some milliseconds begin within a frame: the start falls anywhere.
  wire_free_ = now + random_.below(KZ_STATES_PER_TICK);
  for (const std::uint8_t value : frame) {
    // A host's driver may pause between two bytes.
    if (random_.chance(0.02)) wire_free_ += random_.below(3 * KZ_STATES_PER_BYTE);
    wire_free_ += KZ_STATES_PER_BYTE;
    const bool framing_error = phase_ == Phase::faulty && random_.chance(0.002);
    bytes.push_back({value, wire_free_, framing_error});
  }
  return bytes;
}

void RandomHost::next_phase() {
  static constexpr Phase phases[] = {Phase::orderly, Phase::orderly, Phase::orderly, Phase::burst,
                                     Phase::burst,   Phase::faulty,  Phase::silent};
  phase_ = phases[random_.below(std::size(phases))];
  phase_left_ms_ = 50 + static_cast<int>(random_.below(1450));
}

std::vector<std::uint8_t> RandomHost::request() {
  if (!last_.empty() && random_.chance(0.03)) return last_;  // its reply was lost
  const auto request = requests_.next();
  const std::uint8_t address = random_.chance(0.05) ? KZ_ADDRESS_ALL : KZ_ADDRESS_DEFAULT;
  std::vector<std::uint8_t> body{address, request.front(), ++sequence_};
  body.insert(body.end(), request.begin() + 1, request.end());
  last_ = encode(body);
  return last_;
}

// A frame with a valid checksum and arbitrary contents.
std::vector<std::uint8_t> RandomHost::any_frame() {
  if (random_.chance(0.5)) return request();
  std::vector<std::uint8_t> body(random_.below(KZ_BODY_MAX + 1));
  for (std::uint8_t& byte : body) byte = static_cast<std::uint8_t>(random_.next());
  if (body.size() >= KZ_HEADER_SIZE && random_.chance(0.7)) {
    body[0] = KZ_ADDRESS_DEFAULT;
    body[1] = static_cast<std::uint8_t>(random_.below(0x20));
  }
  return encode(body);
}

RandomAnalog::RandomAnalog(std::uint64_t seed) : seed_(seed), random_(seed) {
  inputs_[KZ_ANALOG_SUPPLY].value = 10000.0 / KZ_SUPPLY_FULL_MV;
  inputs_[KZ_ANALOG_TEMPERATURE].value = 0.25;
}

void RandomAnalog::millisecond() {
  if (--calm_ms_ < -500) calm_ms_ = 1000 + static_cast<int>(random_.below(5000));
  for (unsigned i = 0; i < KZ_ANALOG; ++i) {
    Input& input = inputs_[i];
    if (input.broken_ms > 0) {
      --input.broken_ms;
      continue;
    }
    if (i == KZ_ANALOG_SUPPLY || i == KZ_ANALOG_TEMPERATURE) {
      input.value += 2e-4 * (random_.uniform() - 0.5);
      input.value = std::clamp(input.value, 0.5, 0.8);
    } else if (i != KZ_ANALOG_REFERENCE) {
      // Up to 30 rad/s, 9 in 10 of them under 6: faster than any joint.
      input.velocity = 0.99 * input.velocity + 2e-4 * (random_.uniform() - 0.5);
      input.value += input.velocity;
      if (input.value < 0.05 || input.value > 0.95) input.velocity = -input.velocity;
      if (random_.chance(0.0002)) input.value = random_.uniform();
      input.value = std::clamp(input.value, 0.04, 0.96);
    }
    if (calm_ms_ < 0 && random_.chance(0.0002)) {
      input.broken_ms = 1 + static_cast<int>(random_.below(60));
      input.high = random_.chance(0.5);
    }
  }
}

double RandomAnalog::ratio(unsigned input, States at) const {
  const Input& source = inputs_[input];
  if (source.broken_ms > 0) return source.high ? 1.0 : 0.0;
  const auto tick = static_cast<std::uint64_t>(at / KZ_STATES_PER_TICK);
  return source.value + 0.5 / KZ_POT_CODES * keyed_normal(seed_, tick, input);
}

}  // namespace kaz::sim
