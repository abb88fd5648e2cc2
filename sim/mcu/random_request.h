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

// Damages a frame at random; the frame must not be empty. The function selects one of five faults or no
// fault. All six choices have the same probability. Three of the faults flip a bit, remove a byte, or insert
// a byte. The fourth fault cuts off the end. The fifth fault replaces the frame with up to `max_noise` random
// bytes. After a cut or a replacement, the frame has at least `min_length` bytes (0 or 1). Without a fault,
// the function returns false.
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
