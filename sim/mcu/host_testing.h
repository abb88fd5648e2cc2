// For tests: a host that exchanges frames with a microcontroller through its pins.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "shared/protocol/frame.h"
#include "shared/protocol/messages.h"
#include "sim/mcu/mcu.h"

namespace kaz::sim {

// Encodes a message to the default address.
inline std::vector<std::uint8_t> frame_of(std::uint8_t type, std::uint8_t sequence,
                                          const std::vector<std::uint8_t>& fields) {
  std::vector<std::uint8_t> body{KZ_ADDRESS_DEFAULT, type, sequence};
  body.insert(body.end(), fields.begin(), fields.end());
  std::vector<std::uint8_t> wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

inline std::vector<std::uint8_t> enable_frame(std::uint8_t sequence, std::uint32_t mask) {
  std::vector<std::uint8_t> fields(KZ_PAYLOAD_MAX);
  const kz_enable message{mask};
  fields.resize(kz_pack_enable(&message, fields.data()));
  return frame_of(KZ_TYPE_enable, sequence, fields);
}

// Encodes a request that moves one joint as fast as the joint's ramp allows. `angle` is in units of 100 urad.
inline std::vector<std::uint8_t> target_frame(std::uint8_t sequence, int joint, int angle) {
  std::vector<std::uint8_t> fields(KZ_PAYLOAD_MAX);
  kz_targets message{};
  message.mask = 1u << joint;
  message.angle[joint] = static_cast<s16>(angle);
  fields.resize(kz_pack_targets(&message, fields.data()));
  return frame_of(KZ_TYPE_targets, sequence, fields);
}

// Sends `bytes` back to back from now on. Returns the time at which the last stop bit has passed.
inline States send(Mcu& mcu, const std::vector<std::uint8_t>& bytes) {
  States at = mcu.now();
  for (const std::uint8_t value : bytes) {
    at += KZ_STATES_PER_BYTE;
    mcu.receive({value, at, false});
  }
  return at;
}

// Returns the bodies of the valid frames in `bytes`.
inline std::vector<std::vector<std::uint8_t>> bodies_of(const std::vector<SerialByte>& bytes) {
  std::vector<std::vector<std::uint8_t>> bodies;
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  for (const SerialByte& byte : bytes) {
    if (kz_receive(&receiver, byte.value, 0) == KZ_RECEIVE_FRAME)
      bodies.emplace_back(receiver.body, receiver.body + receiver.length);
  }
  return bodies;
}

// Analog source for tests: the supply is at 10 V, every other input at half scale.
inline double quiet_board(int channel, const PinLevels& levels, States) {
  const int input = channel * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
  if (input == KZ_ANALOG_SUPPLY) return 10000.0 / KZ_SUPPLY_FULL_MV;
  return 0.5;
}

}  // namespace kaz::sim
