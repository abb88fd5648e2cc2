// Motors off at the end of a run whose own requests are out of reach.
// SPDX-License-Identifier: Apache-2.0
#include "tools/run/leave_board.h"

#include "host/link/requester.h"
#include "host/robot/typed_request.h"

namespace kaz::tools {

std::optional<bool> leave_board(const host::RobotBoard& board, host::Clock& clock,
                                Result<kz_statistics_reply>& counts) {
  host::Requester requester(*board.link, clock, {.address = board.address});
  requester.limit_tries(3);
  const host::Request requests[] = {
      host::make_request(KZ_TYPE_enable, kz_enable{0}, kz_pack_enable),
      host::make_request(KZ_TYPE_statistics, kz_statistics{}, kz_pack_statistics)};
  const auto replies = requester.exchange(requests);
  if (!replies) {
    for (int i = 0; i < 3; ++i) (void)requester.send(requests[0]);  // the wire may still carry it
    return std::nullopt;
  }
  counts = host::read_reply((*replies)[1], kz_unpack_statistics_reply);
  const auto off = host::read_reply((*replies)[0], kz_unpack_enable_reply);
  return off && off->mask == 0 && (off->status & KZ_STATUS_ENABLED) == 0;
}

}  // namespace kaz::tools
