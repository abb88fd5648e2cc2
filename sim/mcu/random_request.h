// Generates random requests to the board: every request of the protocol, with valid and with invalid fields.
// SPDX-License-Identifier: Apache-2.0
//
// Fields with bounds (message_info.h) get random values inside, at and outside the bounds. Fields without
// bounds get plausible values, with which the board accepts most requests. Most angles are in the middle half
// of the joint's range. Most calibration values are near the nominal values. Some requests form short
// sequences, such as a calibration and a request to store the calibration.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "shared/base/random.hpp"
#include "shared/protocol/message_info.h"

namespace kaz::sim {

// Usually damages a frame at random. The frame must not be empty. Six outcomes are equally likely: flipped
// bit, removed byte, inserted byte, end of the frame cut off, whole frame replaced by random bytes, no
// damage. If the end of the frame is cut off, at least `min_length` bytes (0 or 1) remain. If random bytes
// replace the frame, the number of these bytes is between `min_length` and `max_noise`. If the outcome is "no
// damage", the function returns false.
bool damage_frame(Random& random, std::vector<std::uint8_t>& frame, std::uint32_t min_length,
                  std::uint32_t max_noise);

class RandomRequest {
 public:
  // `random` must outlive this object.
  explicit RandomRequest(Random& random) : random_(random) {}
  // Returns the next request as type and fields: a body without address and sequence number.
  std::vector<std::uint8_t> next();

 private:
  const kz_message_info& choose();
  std::vector<std::uint8_t> make(const kz_message_info& request, bool legal);
  long long number(const kz_message_info& request, const kz_field_info& field, bool legal);
  std::uint32_t mask(bool legal);
  long long angle(int joint, bool legal);
  long long element(const kz_field_info& field, int joint, bool legal);
  void plan();

  Random& random_;
  std::deque<std::vector<std::uint8_t>> planned_;
};

}  // namespace kaz::sim
