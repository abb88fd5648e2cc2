// The fields of a frame by the names of messages.def, to say where two boards differ.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/protocol/frame.h"
#include "sim/mcu/compare.h"

namespace kaz::sim {

// The body that `sender` is sending, without stuffing: address, type, sequence number, fields. Empty if it
// sends nothing, or its bytes are no stuffed body.
std::vector<std::uint8_t> sent_body(const kz_sender& sender);

// The fields in which two bodies differ: "state_reply.angle[3]", "state_reply.header.sequence". Of different
// messages only "type", with the codes. Empty if the bodies are equal, or one is of no known message.
// Elements that only one body has are left out: their mask differs.
std::vector<CompareDifference> frame_differences(std::span<const std::uint8_t> native,
                                                 std::span<const std::uint8_t> h8);

}  // namespace kaz::sim
