// Identifies the board at the other end of a link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/link/exchanger.h"

namespace kaz::host {

// Succeeds if a Kaz board answers whose protocol version is KZ_PROTOCOL_VERSION_OLDEST to
// KZ_PROTOCOL_VERSION. Else one error sentence for each
// case: no reply; a reply of something other than a Kaz board, with its first bytes; the line echoes; another
// protocol version or number of joints.
Result<kz_identify_reply> identify_board(Exchanger& requester);
// Lateness of either end that a healthy board's identification bears, with all tries of RequesterOptions: a
// reply waits in the port until it is read, and one of an earlier try is taken too. So nothing fails before
// all tries, 0.95 s, have passed; half of it.
inline constexpr Time kIdentifyBears = std::chrono::milliseconds(475);

// "0.2", of identify_reply and of an image's header
std::string firmware_version_text(std::uint16_t version);
// "1a2b3c4d", of both too
std::string build_text(std::uint32_t build_id);
// "Kaz servo board, protocol 3, firmware 0.2, build 1a2b3c4d"
std::string board_text(const kz_identify_reply& identity);
// The safety fault of a firmware that this program still talks to, with the remedy, for behind "the board:";
// empty if none is known.
std::string firmware_fault(const kz_identify_reply& identity);

}  // namespace kaz::host
