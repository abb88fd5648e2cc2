// Requests and replies as the structs of messages.def, and the errors of refused requests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "host/link/exchanger.h"
#include "host/robot/robot.h"

namespace kaz::host {

// The error of a refused request: one sentence with the joint, the reason and the remedy.
// `targets`: those of the request, so that the sentence contains the value; empty for other requests.
Error refusal_error(const kz_refused& refusal, std::span<const JointTarget> targets);

// That of a target outside the limits which are in force on the board, perhaps set by another program:
// narrower than the joint's own they are named, with the way back. `joint` is one of the table.
Error outside_set_limits(int joint, std::span<const JointTarget> targets, const Limits& set,
                         const std::string& recover);

template <class Message>
Request make_request(std::uint8_t type, const Message& message,
                     u8 (*pack)(const Message*, u8* fields)) {
  Request request;
  request.type = type;
  request.fields.length = pack(&message, request.fields.bytes.data());
  return request;
}

template <class Message>
Result<Message> read_reply(const Reply& reply, u8 (*unpack)(Message*, const u8*, u8),
                           std::span<const JointTarget> targets = {}) {
  if (reply.refused) {
    kz_refused refusal{};
    kz_unpack_refused(&refusal, reply.fields.bytes.data(), reply.fields.length);
    return tl::unexpected(refusal_error(refusal, targets));
  }
  Message message{};
  if (!unpack(&message, reply.fields.bytes.data(), reply.fields.length)) {
    return fail(
        Fault::environment,
        "the board sent a reply of a length that does not fit its type: firmware and program "
        "do not fit each other");
  }
  return message;
}

}  // namespace kaz::host
