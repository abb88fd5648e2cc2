// Finds the fields in which two frames differ. Fields have the names in messages.def.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/protocol/frame.h"
#include "sim/mcu/compare.h"

namespace kaz::sim {

// Returns the body of the frame that `sender` is sending, without byte stuffing. The body consists of
// address, type, sequence number and fields. The result is empty if `sender` is not sending a frame or the
// byte stuffing is invalid.
std::vector<std::uint8_t> sent_body(const kz_sender& sender);

// Returns the fields in which two bodies differ, such as "state_reply.angle[3]" or
// "state_reply.header.sequence". If the types differ, the only result is "type (NAME, NAME)" with the two
// type codes. The result is empty if the bodies are equal or a type is unknown. If an array has a mask field,
// a body contains only the array elements whose mask bit is 1. If an element is missing from one of the two
// bodies, the result omits the element. The mask fields of such bodies differ, and the result contains the
// mask field.
std::vector<CompareDifference> frame_differences(std::span<const std::uint8_t> native,
                                                 std::span<const std::uint8_t> h8);

}  // namespace kaz::sim
