// Identifies the board at the other end of a link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/exchanger.h"

namespace kaz::host {

// Succeeds if a Kaz board answers with a protocol version from KZ_PROTOCOL_VERSION_OLDEST to
// KZ_PROTOCOL_VERSION. Fails if no reply came, if the line echoes, or if another device sent bytes (the
// message contains the first bytes). Also fails if the board has another protocol version or another number
// of joints.
Result<kz_identify_reply> identify_board(Exchanger& requester);
// With the default RequesterOptions, a delay of the host or of the board up to kIdentifyBears never makes
// identify_board() fail. If the host is delayed, the reply stays in the port until the host reads it. A late
// reply to an earlier try is valid, too. So identify_board() reports a missing reply only if no try was
// answered. All tries together take 0.95 s, and kIdentifyBears is half of this time.
inline constexpr Time kIdentifyBears = std::chrono::milliseconds(475);

// Returns a version number from an identify_reply or an image header as text, such as "0.2".
std::string firmware_version_text(std::uint16_t version);
// Returns a build id from an identify_reply or an image header as text, such as "1a2b3c4d".
std::string build_text(std::uint32_t build_id);
// Returns a text such as "Kaz servo board, protocol 3, firmware 0.2, build 1a2b3c4d".
std::string board_text(const kz_identify_reply& identity);
// If the board's firmware has a known safety fault, returns a text that describes the fault and its remedy.
// Otherwise returns an empty text. The caller writes "the board:" before the returned text.
std::string firmware_fault(const kz_identify_reply& identity);

}  // namespace kaz::host
