// Packs requests, unpacks replies, and creates the errors of refused requests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "host/link/exchanger.h"
#include "host/robot/robot.h"

namespace kaz::host {

// Returns the error of a refused request: one sentence with joint, reason and remedy. `targets`: the targets
// in the request, so that the message contains the refused value; empty for a request without targets.
Error refusal_error(const kz_refused& refusal, std::span<const JointTarget> targets);

// Returns the error for a target outside the joint's present limits. `set`: the present limits of the joint
// on the board, possibly set by another program. `recover`: a command that restores the joint's own limits.
// If the present limits are narrower than the joint's own limits, the message contains the present limits and
// this command. `joint` must be in the joint table.
Error outside_set_limits(int joint, std::span<const JointTarget> targets, const Limits& set,
                         const std::string& recover);

// Packs `message` into a request.
template <class Message>
Request make_request(std::uint8_t type, const Message& message,
                     u8 (*pack)(const Message*, u8* fields)) {
  Request request;
  request.type = type;
  request.fields.length = pack(&message, request.fields.bytes.data());
  return request;
}

// Unpacks a reply. Fails if the request was refused (refusal_error), or if the reply's length does not match
// its type (environment).
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
    return fail(Fault::environment,
                "the board sent a reply whose length does not fit the reply's type: firmware and "
                "program do not match; update the older of the two");
  }
  return message;
}

}  // namespace kaz::host
