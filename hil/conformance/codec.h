// The wire format of docs/reference/protocol.md once more, written from the document alone (frames and CRC).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vision/image/frame.h"  // Time

namespace kaz::hil {

using Bytes = std::vector<std::uint8_t>;

std::uint16_t crc_of(const Bytes& stuffed);
Bytes stuff(const Bytes& body);
// The three bytes that carry a CRC.
Bytes check_of(std::uint16_t crc);
// A whole frame with both zeros around bytes that are stuffed already, right or wrong.
Bytes frame_of_stuffed(const Bytes& stuffed);
Bytes frame_of(std::uint8_t address, std::uint8_t type, std::uint8_t sequence, const Bytes& fields);

struct Frame {
  std::uint8_t address = 0, type = 0, sequence = 0;
  Bytes fields;
  Time at{};  // when its last byte was read
};

// Takes what a board sends apart.
class Deframer {
 public:
  // A frame, when this byte ends one.
  std::optional<Frame> take(std::uint8_t byte, Time at);
  // Bytes outside frames, and frames that were damaged or lacked a zero of their own.
  int faults() const { return faults_; }
  void forget() { *this = {}; }

 private:
  std::optional<Frame> end(Time at);
  bool in_frame_ = false;
  Bytes bytes_;
  int faults_ = 0;
};

}  // namespace kaz::hil
