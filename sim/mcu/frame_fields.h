// Names the fields in which two frames differ, as in messages.def.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/protocol/frame.h"
#include "sim/mcu/compare.h"

namespace kaz::sim {

// Returns the body that `sender` is sending, without stuffing: address, type, sequence number, fields. It is
// empty if nothing is being sent or the stuffing is invalid.
std::vector<std::uint8_t> sent_body(const kz_sender& sender);

// Returns the fields in which two bodies differ, such as "state_reply.angle[3]" or
// "state_reply.header.sequence". If the types differ, it returns only "type (NAME, NAME)" with the codes. It
// returns nothing if the bodies are equal or a type is unknown. Elements that only one body has are omitted,
// because their mask differs.
std::vector<CompareDifference> frame_differences(std::span<const std::uint8_t> native,
                                                 std::span<const std::uint8_t> h8);

}  // namespace kaz::sim
