// Generates requests with legal, boundary and illegal fields, from the protocol's table.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/fuzz/choices.h"
#include "shared/protocol/message_info.h"

namespace kaz::hil::fuzz {

struct RequestBytes {
  std::vector<std::uint8_t> body;  // address, type, sequence number, fields
  std::string text;
};

// Returns all request types of the table, without those that write flash if `flash` is false.
std::vector<const kz_message_info*> request_types(bool flash);

// Makes a request. If `legal`, all fields are within the bounds of the table, but targets may be beyond a
// soft limit that was set before. Otherwise each field may be any value of its type.
RequestBytes make_request(const kz_message_info& message, Choices& choices, bool legal,
                          std::uint8_t address, std::uint8_t sequence);

// Returns the frame on the wire of a body.
std::vector<std::uint8_t> framed(const std::vector<std::uint8_t>& body);
// The same from separate parts.
std::vector<std::uint8_t> framed(std::uint8_t address, std::uint8_t type, std::uint8_t sequence,
                                 const std::vector<std::uint8_t>& fields);

}  // namespace kaz::hil::fuzz
