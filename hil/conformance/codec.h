// Independent codec of frames and CRC, written only from docs/reference/protocol.md and not from the code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/time.hpp"

namespace kaz::hil {

using Bytes = std::vector<std::uint8_t>;

std::uint16_t crc_of(const Bytes& stuffed);
Bytes stuff(const Bytes& body);
// Returns the three bytes that encode a CRC.
Bytes check_of(std::uint16_t crc);
// Returns a whole frame: a zero, the bytes of `stuffed`, the CRC, and a zero. `stuffed` may be stuffed
// incorrectly.
Bytes frame_of_stuffed(const Bytes& stuffed);
Bytes frame_of(std::uint8_t address, std::uint8_t type, std::uint8_t sequence, const Bytes& fields);

struct Frame {
  std::uint8_t address = 0, type = 0, sequence = 0;
  Bytes fields;
  Time at{};  // time at which the last byte was read
};

// Splits the byte stream from a board into frames.
class Deframer {
 public:
  // Returns a frame if this byte is the last byte of a valid frame.
  std::optional<Frame> take(std::uint8_t byte, Time at);
  // Returns the number of bytes outside frames, plus the number of damaged frames, plus the number of extra
  // zeros.
  int faults() const { return faults_; }
  void forget() { *this = {}; }

 private:
  std::optional<Frame> end(Time at);
  bool in_frame_ = false;
  Bytes bytes_;
  int faults_ = 0;
};

}  // namespace kaz::hil
