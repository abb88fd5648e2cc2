// Identifies the board at the other end of a link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/exchanger.h"

namespace kaz::host {

// Succeeds if a Kaz board answers with a protocol version from KZ_PROTOCOL_VERSION_OLDEST to
// KZ_PROTOCOL_VERSION. Errors, one sentence each: no reply came, the line echoes, or another device sent
// bytes (the sentence contains the first of these). Also: the board has another protocol version or another
// number of joints.
Result<kz_identify_reply> identify_board(Exchanger& requester);
// Delay of host or board that identify_board() tolerates with the defaults of RequesterOptions. Late replies
// wait in the port, and replies to earlier tries count. So identify_board() fails only after all tries, which
// take 0.95 s. The tolerated delay is half of this time.
inline constexpr Time kIdentifyBears = std::chrono::milliseconds(475);

// "0.2", from identify_reply or an image header
std::string firmware_version_text(std::uint16_t version);
// "1a2b3c4d", from identify_reply or an image header
std::string build_text(std::uint32_t build_id);
// "Kaz servo board, protocol 3, firmware 0.2, build 1a2b3c4d"
std::string board_text(const kz_identify_reply& identity);
// Describes a known safety fault of a supported old firmware, with the remedy. The caller writes "the board:"
// before this text. Empty if the firmware has no known fault.
std::string firmware_fault(const kz_identify_reply& identity);

}  // namespace kaz::host
