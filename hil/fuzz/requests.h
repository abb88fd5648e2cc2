// Requests with legal, boundary and illegal fields, from the protocol's table.
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

// All request types of the table; without those that write flash if `flash` is false.
std::vector<const kz_message_info*> request_types(bool flash);

// `legal`: no field is out of the table's bounds (targets may still be beyond a soft limit that was
// set
// before). Else each field may be anything its type can hold.
RequestBytes make_request(const kz_message_info& message, Choices& choices, bool legal,
                          std::uint8_t address, std::uint8_t sequence);

std::vector<std::uint8_t> framed(const std::vector<std::uint8_t>& body);
// The same from its parts.
std::vector<std::uint8_t> framed(std::uint8_t address, std::uint8_t type, std::uint8_t sequence,
                                 const std::vector<std::uint8_t>& fields);

}  // namespace kaz::hil::fuzz
