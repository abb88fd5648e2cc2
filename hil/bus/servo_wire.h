// Packets of Feetech's and ROBOTIS's buses once more, written from docs/reference alone, for the judge.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hil/conformance/codec.h"  // Bytes

namespace kaz::hil {

enum class ServoFamily { feetech, dynamixel };

inline constexpr int kAllServos = 254;

// The request on the wire.
Bytes servo_request(ServoFamily family, int id, int instruction, const Bytes& parameters = {});
// Its last byte, which is part of the checksum or CRC, is wrong.
Bytes damaged(Bytes request);

struct ServoAnswer {
  int id = 0;
  int error = 0;  // status bits of Feetech's; ROBOTIS's error byte
  Bytes data;
  bool operator==(const ServoAnswer&) const = default;
};

// Takes apart what came from a bus.
struct ServoAnswers {
  std::vector<ServoAnswer> all;
  int damaged = 0;    // packets whose checksum, CRC or length is wrong
  int stray = 0;      // bytes outside of packets
  bool open = false;  // a packet has begun and is not whole
};
ServoAnswers answers_in(ServoFamily family, const Bytes& bytes);

}  // namespace kaz::hil
