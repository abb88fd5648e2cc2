// The replies of several boards as one.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "host/robot/board_group_parts.h"
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

template <class Number>
void add_up(Number& to, Number more) {
  to = static_cast<Number>(std::min<unsigned long>(0xFFFF, static_cast<unsigned long>(to) + more));
}

void combine(kz_identify_reply& all, const kz_identify_reply& one) {
  all.protocol_version = std::min(all.protocol_version, one.protocol_version);
  all.capabilities &= one.capabilities;
  if (one.watchdog_10ms != 0 && (all.watchdog_10ms == 0 || one.watchdog_10ms < all.watchdog_10ms))
    all.watchdog_10ms = one.watchdog_10ms;
}

void combine(kz_enable_reply& all, const kz_enable_reply& one) {
  all.mask |= one.mask;
}

void combine(kz_read_targets_reply& all, const kz_read_targets_reply& one) {
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    if (one.mask >> j & 1) all.angle[j] = one.angle[j];
  }
  all.mask |= one.mask;
}

void combine(kz_joints_reply& all, const kz_joints_reply& one) {
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    if ((one.mask >> j & 1) == 0) continue;
    all.angle[j] = one.angle[j];
    all.speed[j] = one.speed[j];
    all.duty[j] = one.duty[j];
    all.load[j] = one.load[j];
    all.faults[j] = one.faults[j];
  }
  all.mask |= one.mask;
}

void combine(kz_health_reply& all, const kz_health_reply& one) {
  const bool shut_down = (one.status >> 8) != KZ_SHUTDOWN_NONE;
  if (shut_down && (all.status >> 8) == KZ_SHUTDOWN_NONE) {
    all.status = one.status;
    all.detail = one.detail;
    // By its age: the clocks of two boards have different zeros.
    all.shutdown_tick = all.tick - (one.tick - one.shutdown_tick);
  }
  all.supply_mv = std::min(all.supply_mv, one.supply_mv);
  all.supply_lowest_mv = std::min(all.supply_lowest_mv, one.supply_lowest_mv);
  all.temperature_dc = std::max(all.temperature_dc, one.temperature_dc);
  const auto off = [](u16 reference) { return std::abs(int{reference} - 512); };
  if (off(one.reference) > off(all.reference)) all.reference = one.reference;
}

void combine(kz_statistics_reply& all, const kz_statistics_reply& one) {
  all.busy_8states = std::max(all.busy_8states, one.busy_8states);
  all.worst_8states = std::max(all.worst_8states, one.worst_8states);
  all.frames = static_cast<u16>(all.frames + one.frames);  // modulo 65536, as each
  for (u16 kz_statistics_reply::*count :
       {&kz_statistics_reply::missed_ticks, &kz_statistics_reply::repetitions,
        &kz_statistics_reply::refusals, &kz_statistics_reply::bad_check,
        &kz_statistics_reply::bad_stuffing, &kz_statistics_reply::too_short,
        &kz_statistics_reply::too_long, &kz_statistics_reply::line_errors,
        &kz_statistics_reply::overruns, &kz_statistics_reply::idle,
        &kz_statistics_reply::telemetry_dropped})
    add_up(all.*count, one.*count);
}

void combine(kz_self_test_reply& all, const kz_self_test_reply& one) {
  all.done &= one.done;
  all.failed |= one.failed;
  all.start_8states = std::max(all.start_8states, one.start_8states);
}

void combine(kz_store_calibration_reply& all, const kz_store_calibration_reply& one) {
  all.sequence = std::min(all.sequence, one.sequence);
  all.erases_a = std::max(all.erases_a, one.erases_a);
  all.erases_b = std::max(all.erases_b, one.erases_b);
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

// Of those that a request concerns: the first one's, and the others' added by combine().
template <class Message, class Parts>
void merge_as(const Parts& parts, Reply& merged, u8 (*pack)(const Message*, u8*),
              u8 (*unpack)(Message*, const u8*, u8)) {
  std::optional<Message> all;
  for (const auto& part : parts) {
    Message one{};
    const Fields& fields = part.reply->fields;
    if (!part.concerned || !unpack(&one, fields.bytes.data(), fields.length)) continue;
    if (!all) {
      all = one;
    } else {
      combine(*all, one);
    }
  }
  if (all) merged.fields.length = pack(&*all, merged.fields.bytes.data());
}

}  // namespace

void BoardGroup::merge_fields(const Exchange& exchange, Reply& merged) {
  const auto& parts = exchange.parts;
  switch (exchange.request.type) {
    case KZ_TYPE_state:
      return merge_state(exchange, merged);
    case KZ_TYPE_calibration:
      return merge_calibration(exchange, merged);
    case KZ_TYPE_identify:
      return merge_as(parts, merged, kz_pack_identify_reply, kz_unpack_identify_reply);
    case KZ_TYPE_enable:
      return merge_as(parts, merged, kz_pack_enable_reply, kz_unpack_enable_reply);
    case KZ_TYPE_read_targets:
      return merge_as(parts, merged, kz_pack_read_targets_reply, kz_unpack_read_targets_reply);
    case KZ_TYPE_joints:
      return merge_as(parts, merged, kz_pack_joints_reply, kz_unpack_joints_reply);
    case KZ_TYPE_health:
      return merge_as(parts, merged, kz_pack_health_reply, kz_unpack_health_reply);
    case KZ_TYPE_statistics:
      return merge_as(parts, merged, kz_pack_statistics_reply, kz_unpack_statistics_reply);
    case KZ_TYPE_self_test:
      return merge_as(parts, merged, kz_pack_self_test_reply, kz_unpack_self_test_reply);
    case KZ_TYPE_store_calibration:
      return merge_as(parts, merged, kz_pack_store_calibration_reply,
                      kz_unpack_store_calibration_reply);
    default:  // acknowledgements; settings and inertial codes, which one board has
      return;
  }
}

void BoardGroup::merge_calibration(const Exchange& exchange, Reply& merged) {
  std::optional<kz_calibration_reply> all;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    kz_calibration_reply one{};
    const Fields& fields = exchange.parts[i].reply->fields;
    if (!kz_unpack_calibration_reply(&one, fields.bytes.data(), fields.length)) return;
    if (!all) all = one;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      if ((members_[i]->board.joints >> j & 1) == 0) continue;
      all->centre[j] = one.centre[j];
      all->scale[j] = one.scale[j];
    }
    // None is stored as long as one board has none.
    if (one.sequence < all->sequence) {
      all->sequence = one.sequence;
      all->source = one.source;
    }
    all->erases_a = std::max(all->erases_a, one.erases_a);
    all->erases_b = std::max(all->erases_b, one.erases_b);
  }
  merged.fields.length = kz_pack_calibration_reply(&*all, merged.fields.bytes.data());
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

void BoardGroup::merge_state(const Exchange& exchange, Reply& merged) {
  kz_state_reply all{};
  Time common{};
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = *members_[i];
    kz_state_reply one{};
    const Fields& fields = exchange.parts[i].reply->fields;
    if (!kz_unpack_state_reply(&one, fields.bytes.data(), fields.length)) return;
    Member::State state{
        member.relation.known() ? member.relation.host_time(one.tick) : Time::zero(), {}};
    std::copy(std::begin(one.angle), std::end(one.angle), state.angle.begin());
    if (i == 0) {
      all = one;
      common = state.time;
    }
    member.before = std::exchange(member.latest, state);
    all.supply_mv = std::min(all.supply_mv, one.supply_mv);
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      if (member.board.joints >> j & 1)
        all.angle[j] = i == 0 ? one.angle[j] : member.angle_at(j, common);
    }
  }
  merged.fields.length = kz_pack_state_reply(&all, merged.fields.bytes.data());
}

}  // namespace kaz::host
