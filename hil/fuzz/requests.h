// Generates requests with legal, boundary and illegal fields, from the message table of the protocol.
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

// Returns all request types of the table. If `flash` is false, types that write flash are omitted.
std::vector<const kz_message_info*> request_types(bool flash);

// Makes a request. If `legal` is true, all fields are within the bounds of the table. However, a target can
// exceed a soft limit that an earlier request has set. If `legal` is false, each field can have any value of
// its type.
RequestBytes make_request(const kz_message_info& message, Choices& choices, bool legal,
                          std::uint8_t address, std::uint8_t sequence);

// Encodes this body as a frame, and returns the bytes on the wire.
std::vector<std::uint8_t> framed(const std::vector<std::uint8_t>& body);
// Encodes these parts as a frame, and returns the bytes on the wire.
std::vector<std::uint8_t> framed(std::uint8_t address, std::uint8_t type, std::uint8_t sequence,
                                 const std::vector<std::uint8_t>& fields);

}  // namespace kaz::hil::fuzz
