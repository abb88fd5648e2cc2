// The replies of several boards as one.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "host/robot/board_group_parts.h"
#include "host/robot/merge_rules.h"
#include "host/robot/typed_request.h"

namespace kaz::host {

namespace {

constexpr std::int32_t kTickSlack = 5;  // as Robot's: telemetry and a reply may be a tick apart

std::uint32_t number_at(const Fields& fields, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + size; ++i) value = value << 8 | fields.bytes[i];
  return value;
}

void put_at(Fields& fields, std::size_t at, std::size_t size, std::uint32_t value) {
  for (std::size_t i = 0; i < size; ++i)
    fields.bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * (size - 1 - i)));
}

// identify_reply has the protocol version in front of it.
std::size_t status_place(std::uint8_t request, const Reply& reply) {
  return !reply.refused && request == KZ_TYPE_identify ? 6 : 4;
}

}  // namespace

void BoardGroup::Member::relate(std::uint8_t request, const Reply& reply) {
  if (reply.fields.length < status_place(request, reply) + 2) return;
  const std::uint32_t tick = number_at(reply.fields, 0, 4);
  if (reply.timed)
    relation.add({reply.sent, reply.received, reply.bytes_out, reply.bytes_in, tick});
  restarted =
      restarted || (last_tick && static_cast<std::int32_t>(tick - *last_tick) < -kTickSlack);
  last_tick = tick;
  status = static_cast<std::uint16_t>(number_at(reply.fields, status_place(request, reply), 2));
}

bool BoardGroup::take_restart() {
  bool any = false;
  for (const auto& member : members_) any = std::exchange(member->restarted, false) || any;
  return any;
}

// Tick, timing and status are those of all; the fields behind them those of the boards it concerns.
Reply BoardGroup::merge(const Exchange& exchange) {
  const auto concerned = std::ranges::find_if(exchange.parts, &Exchange::Part::concerned);
  const auto refused = std::ranges::find_if(exchange.parts, [](const Exchange::Part& part) {
    return part.concerned && part.reply->refused;
  });
  Reply merged = refused != exchange.parts.end()     ? *refused->reply
                 : concerned != exchange.parts.end() ? *concerned->reply
                                                     : *exchange.parts.front().reply;
  if (!merged.refused) {
    merge_fields(exchange, merged);
  } else if (exchange.request.type == KZ_TYPE_enable) {
    switch_off();
  }
  const Reply& reference = *exchange.parts.front().reply;
  merged.timed = reference.timed;
  merged.sent = reference.sent;
  merged.received = reference.received;
  merged.bytes_out = reference.bytes_out;
  merged.bytes_in = reference.bytes_in;
  const std::size_t place = status_place(exchange.request.type, merged);
  if (merged.fields.length < place + 2 || reference.fields.length < 4) return merged;
  put_at(merged.fields, 0, 4, number_at(reference.fields, 0, 4));
  put_at(merged.fields, place, 2, merge_status());
  return merged;
}

std::uint16_t BoardGroup::merge_status() {
  unsigned flags = 0, reason = KZ_SHUTDOWN_NONE;
  bool unlocked = true, expected = false, as_expected = true;
  for (const auto& member : members_) {
    flags |= member->status & 0xFFU;
    unlocked = unlocked && (member->status & KZ_STATUS_UNLOCKED);
    if (member->to_be_on != 0) {
      expected = true;
      as_expected = as_expected && (member->status & KZ_STATUS_ENABLED);
    }
    const unsigned own = member->status >> 8;
    const bool weak =
        reason == KZ_SHUTDOWN_NONE || (reason == KZ_SHUTDOWN_LINK_LOST && own != KZ_SHUTDOWN_NONE);
    if (weak) reason = own;
  }
  if (!unlocked) flags &= ~static_cast<unsigned>(KZ_STATUS_UNLOCKED);
  if (expected && !as_expected) flags &= ~static_cast<unsigned>(KZ_STATUS_ENABLED);
  // One robot: a shutdown of a part is one of all.
  if (expected && reason != KZ_SHUTDOWN_NONE && reason != KZ_SHUTDOWN_LINK_LOST) switch_off();
  // The request to be off may have been lost.
  for (const auto& member : members_) {
    if (member->to_be_off && (member->status & KZ_STATUS_ENABLED)) switch_off(*member);
  }
  return static_cast<std::uint16_t>(reason << 8 | flags);
}

// The motors of all boards. Not waited for: the status of each one's next reply shows whether it was done.
void BoardGroup::switch_off() {
  for (const auto& member : members_) switch_off(*member);
}

void BoardGroup::switch_off(Member& member) {
  member.to_be_on = 0;
  member.to_be_off = true;
  (void)member.requester.send(make_request(KZ_TYPE_enable, kz_enable{}, kz_pack_enable));
}

namespace {

// apply_rules() merges `one` into `all`: it applies the rule of each field. Requests have no rules, so for
// their types these templates are never instantiated.
#define KZ_MESSAGE(name, code, kind, text)                                               \
  template <class Rules>                                                                 \
  void apply_rules([[maybe_unused]] const Rules& rules, [[maybe_unused]] kz_##name& all, \
                   [[maybe_unused]] const kz_##name& one, [[maybe_unused]] std::uint32_t joints) {
#define KZ_FIELD(type, name, unit, text) rules.name(all.name, one.name);
#define KZ_ARRAY(type, name, count, unit, text) rules.name(all.name, one.name, joints);
#define KZ_MASKED(type, name, mask, most, unit, text) rules.name(all.name, one.name, one.mask);
#define KZ_END() }
#include "shared/protocol/messages.def"

// Merges the replies of this code and kind. Does nothing for other messages than replies.
template <u8 code, kz_kind kind, class Message>
void merge_as(const auto& parts, const auto& members, Reply& merged,
              u8 (*pack)(const Message*, u8*), u8 (*unpack)(Message*, const u8*, u8)) {
  if constexpr ((code & KZ_REPLY) && kind != KZ_KIND_TELEMETRY && kind != KZ_KIND_REFUSAL) {
    const std::conditional_t<kind == KZ_KIND_ACKNOWLEDGEMENT, merging::TickAndStatus,
                             merging::Rules<Message>>
        rules{};
    std::optional<Message> all;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (!parts[i].concerned) continue;
      Message one{};
      const Fields& fields = parts[i].reply->fields;
      if (!unpack(&one, fields.bytes.data(), fields.length)) return;
      if constexpr (std::is_same_v<Message, kz_state_reply>)
        members[i]->align(one, *members.front());
      if (!all) {
        all = one;
        continue;
      }
      apply_rules(rules, *all, one, members[i]->board.joints);
      rules.merge_rest(*all, one);
    }
    if (all) merged.fields.length = pack(&*all, merged.fields.bytes.data());
  }
}

}  // namespace

void BoardGroup::merge_fields(const Exchange& exchange, Reply& merged) {
  switch (exchange.request.type + KZ_REPLY) {
#define KZ_MESSAGE(name, code, kind, text)                                                  \
  case code:                                                                                \
    return merge_as<code, KZ_KIND_##kind>(exchange.parts, members_, merged, kz_pack_##name, \
                                          kz_unpack_##name);
#include "shared/protocol/messages.def"
  }
}

void BoardGroup::Member::align(kz_state_reply& one, const Member& reference) {
  State state{relation.known() ? relation.host_time(one.tick) : Time::zero(), {}};
  std::copy(std::begin(one.angle), std::end(one.angle), state.angle.begin());
  before = std::exchange(latest, state);
  if (this == &reference) return;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    if (board.joints >> j & 1) one.angle[j] = angle_at(j, reference.latest->time);
  }
}

s16 BoardGroup::Member::angle_at(std::size_t joint, Time t) const {
  const s16 now = latest->angle[joint];
  if (!before || latest->time <= before->time || latest->time - before->time > kMaxBetween)
    return now;
  t = std::clamp(t, before->time, latest->time + kMaxAhead);
  const double share = seconds(t - latest->time) / seconds(latest->time - before->time);
  const double angle = now + share * (now - before->angle[joint]);
  return static_cast<s16>(std::lround(std::clamp(angle, -32768.0, 32767.0)));
}

}  // namespace kaz::host
