// Random requests to the board: every message of the table, valid and invalid.
// SPDX-License-Identifier: Apache-2.0
//
// Fields are drawn from the table's bounds (message_info.h): inside, at the edges, outside. Fields without
// bounds are drawn so that most requests succeed: angles near the middle of the joint's range, calibration
// near nominal. Some requests form short sequences: unlock and raw drive, calibrate and store, reset.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "shared/base/random.hpp"
#include "shared/protocol/message_info.h"

namespace kaz::sim {

// Damages a frame with one of five random faults: a bit flipped, a byte lost, a byte inserted, the end
// cut off, or all of it replaced by up to `max_noise` random bytes; at least `min_length` bytes are
// left of the last two. One time in six it leaves the frame alone and returns false.
bool damage_frame(Random& random, std::vector<std::uint8_t>& frame, std::uint32_t min_length,
                  std::uint32_t max_noise);

class RandomRequest {
 public:
  explicit RandomRequest(Random& random) : random_(random) {}
  // Type and fields: a body without address and sequence number.
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
