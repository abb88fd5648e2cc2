// Packet codec for Feetech and ROBOTIS buses, for the conformance cases. The codec shares no code with the
// drivers and was written only from docs/reference/servo-bus.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/conformance/codec.h"  // Bytes

namespace kaz::hil {

enum class ServoFamily { feetech, dynamixel };

// Broadcast id.
inline constexpr int kAllServos = 254;

// Returns the request as bytes on the wire.
Bytes servo_request(ServoFamily family, int id, int instruction, const Bytes& parameters = {});
// Returns the request with a wrong last byte, which is part of the checksum or CRC.
Bytes damaged(Bytes request);

struct ServoAnswer {
  int id = 0;
  int error = 0;  // Feetech: status bits; ROBOTIS: error byte
  Bytes data;
  bool operator==(const ServoAnswer&) const = default;
};

// Result of parsing the bytes received from a bus.
struct ServoAnswers {
  std::vector<ServoAnswer> all;
  int damaged = 0;    // number of packets with a wrong checksum, CRC or length
  int stray = 0;      // number of bytes outside packets
  bool open = false;  // the last packet is incomplete
};
ServoAnswers answers_in(ServoFamily family, const Bytes& bytes);

}  // namespace kaz::hil
