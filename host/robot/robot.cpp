// Robot over the requester, the clock relation and the posture history.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/robot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/robot/clock_relation.h"
#include "host/robot/connect.h"
#include "host/robot/posture_history.h"
#include "host/robot/refusal.h"
#include "host/robot/requester.h"

namespace kaz::host {

namespace {

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

// A number for the wire, or nothing if it does not fit into the field.
template <class Number>
std::optional<Number> to_wire(double value) {
  const double rounded = std::round(value);
  if (!(rounded >= std::numeric_limits<Number>::min() &&
        rounded <= std::numeric_limits<Number>::max())) {
    return std::nullopt;
  }
  return static_cast<Number>(rounded);
}

Result<Request> targets_request(std::span<const JointTarget> targets, Time duration) {
  kz_targets message{};
  const auto duration_ms = to_wire<u16>(seconds(duration) * 1e3);
  if (!duration_ms) return fail(Fault::usage, "a target's duration must be 0 to 65 s");
  message.duration_ms = *duration_ms;
  for (const JointTarget& target : targets) {
    if (target.joint < 0 || target.joint >= KZ_JOINTS) {
      return fail(Fault::usage, "there is no joint " + std::to_string(target.joint) +
                                    ": joints are numbered 0 to " + std::to_string(KZ_JOINTS - 1));
    }
    const auto angle = to_wire<s16>(target.angle_rad * KZ_ANGLE_PER_RAD);
    if (!angle) {
      kz_refused limit{};
      limit.request = KZ_TYPE_targets;
      limit.reason = KZ_REFUSED_LIMIT;
      limit.detail = static_cast<u8>(target.joint);
      return tl::unexpected(refusal_error(limit, targets));
    }
    message.mask |= u32{1} << target.joint;
    message.angle[target.joint] = *angle;
  }
  return make_request(KZ_TYPE_targets, message, kz_pack_targets);
}

Request state_request() {
  return make_request(KZ_TYPE_state, kz_state{}, kz_pack_state);
}

}  // namespace

struct Robot::Parts {
  Parts(Link& link, Clock& on_clock, const ConnectOptions& options)
      : clock(on_clock),
        requester(link, on_clock, {options.address, options.timeout, options.retries}),
        relation(link.byte_time()) {}

  template <class Message, class Answer>
  Result<Answer> ask(std::uint8_t type, const Message& message, u8 (*pack)(const Message*, u8*),
                     u8 (*unpack)(Answer*, const u8*, u8)) {
    const Request request = make_request(type, message, pack);
    const auto replies = requester.ask({&request, 1});
    if (!replies) return tl::unexpected(replies.error());
    const auto answer = read_reply(replies->front(), unpack);
    if (answer) relate(replies->front(), answer->tick);
    return answer;
  }

  void relate(const Reply& reply, std::uint32_t tick) {
    if (!reply.timed) return;
    relation.add({reply.sent, reply.received, reply.bytes_out, reply.bytes_in, tick});
  }

  Result<Posture> take_state(const Reply& reply) {
    const auto state = read_reply(reply, kz_unpack_state_reply);
    if (!state) return tl::unexpected(state.error());
    relate(reply, state->tick);
    Posture posture;
    posture.time = relation.host_time(state->tick);
    posture.tick = state->tick;
    posture.status = state->status;
    posture.supply_volts = state->supply_mv * 1e-3;
    for (std::size_t j = 0; j < posture.angle.size(); ++j) {
      posture.angle[j] = static_cast<double>(state->angle[j]) / KZ_ANGLE_PER_RAD;
    }
    history.add(posture);
    return posture;
  }

  Clock& clock;
  Requester requester;
  ClockRelation relation;
  PostureHistory history;
  kz_identify_reply identity{};
};

Robot::Robot(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Robot::Robot(Robot&&) noexcept = default;
Robot& Robot::operator=(Robot&&) noexcept = default;
Robot::~Robot() = default;

Result<Robot> Robot::connect(Link& link, Clock& clock, const ConnectOptions& options) {
  auto parts = std::make_unique<Parts>(link, clock, options);
  if (auto found = identify_board(parts->requester); !found) return tl::unexpected(found.error());
  // Once more: this answer also relates the clocks.
  const auto identity =
      parts->ask(KZ_TYPE_identify, kz_identify{}, kz_pack_identify, kz_unpack_identify_reply);
  if (!identity) return tl::unexpected(identity.error());
  parts->identity = *identity;
  return Robot(std::move(parts));
}

const kz_identify_reply& Robot::identity() const {
  return parts_->identity;
}
Clock& Robot::clock() {
  return parts_->clock;
}

Result<void> Robot::enable(std::uint32_t mask) {
  if (mask != 0) {
    const auto cleared =
        parts_->ask(KZ_TYPE_clear, kz_clear{}, kz_pack_clear, kz_unpack_clear_reply);
    if (!cleared) return tl::unexpected(cleared.error());
  }
  const auto reply =
      parts_->ask(KZ_TYPE_enable, kz_enable{mask}, kz_pack_enable, kz_unpack_enable_reply);
  if (!reply) return tl::unexpected(reply.error());
  if (reply->mask != mask) {
    const auto faults = fault_sentence(reply->status);
    return fail(Fault::environment, "the board did not switch the motors as it was asked to" +
                                        (faults ? ": " + *faults : std::string()));
  }
  return {};
}

Result<void> Robot::set_gains(std::uint32_t mask, const Gains& gains) {
  // Units of messages.def: 1/256 per rad, 1/4096 s/rad, 100 urad/ms (0.1 rad/s).
  const auto kp = to_wire<u16>(gains.kp_per_rad * 256);
  const auto kd = to_wire<u16>(gains.kd_s_per_rad * 4096);
  const auto ramp = to_wire<u16>(gains.ramp_rad_per_s * 10);
  if (!kp || *kp > KZ_KP_MAX || !kd || *kd > KZ_KD_MAX || !ramp || *ramp < 1 ||
      *ramp > KZ_RAMP_MAX) {
    return fail(Fault::usage,
                "gains out of range: kp 0..80 /rad, kd 0..1 s/rad, ramp 0.1..12 rad/s");
  }
  const auto reply = parts_->ask(KZ_TYPE_gains, kz_gains{mask, *kp, *kd, 0, 0}, kz_pack_gains,
                                 kz_unpack_gains_reply);
  if (!reply) return tl::unexpected(reply.error());
  const auto limited = parts_->ask(KZ_TYPE_limits, kz_limits{mask, *ramp, INT16_MIN, INT16_MAX},
                                   kz_pack_limits, kz_unpack_limits_reply);
  if (!limited) return tl::unexpected(limited.error());
  return {};
}

Result<void> Robot::set_targets(std::span<const JointTarget> targets, Time duration) {
  const auto request = targets_request(targets, duration);
  if (!request) return tl::unexpected(request.error());
  const auto replies = parts_->requester.ask({&*request, 1});
  if (!replies) return tl::unexpected(replies.error());
  const auto reply = read_reply(replies->front(), kz_unpack_targets_reply, targets);
  if (!reply) return tl::unexpected(reply.error());
  parts_->relate(replies->front(), reply->tick);
  return {};
}

Result<Posture> Robot::state() {
  const Request request = state_request();
  const auto replies = parts_->requester.ask({&request, 1});
  if (!replies) return tl::unexpected(replies.error());
  return parts_->take_state(replies->front());
}

Result<Posture> Robot::exchange(std::span<const JointTarget> targets, Time duration) {
  if (targets.empty()) return state();
  const auto move = targets_request(targets, duration);
  if (!move) return tl::unexpected(move.error());
  // The targets first: their short reply leaves the board's sender free for the long one of the
  // state.
  const Request requests[] = {*move, state_request()};
  const auto replies = parts_->requester.ask(requests);
  if (!replies) return tl::unexpected(replies.error());
  const auto taken = read_reply((*replies)[0], kz_unpack_targets_reply, targets);
  if (taken) parts_->relate((*replies)[0], taken->tick);
  auto posture = parts_->take_state((*replies)[1]);
  if (!taken) {
    // Why the targets were refused the state may tell better.
    if (posture && (posture->status & kMotorsOffFaults)) {
      return fail(Fault::environment, *fault_sentence(posture->status));
    }
    return tl::unexpected(taken.error());
  }
  return posture;
}

Result<kz_heartbeat_reply> Robot::heartbeat(Time watchdog) {
  const auto limit = to_wire<u8>(seconds(watchdog) * 100);
  if (!limit || *limit > 100) {
    return fail(Fault::usage, "the link watchdog's limit must be 10 ms to 1 s");
  }
  return parts_->ask(KZ_TYPE_heartbeat, kz_heartbeat{*limit, 0}, kz_pack_heartbeat,
                     kz_unpack_heartbeat_reply);
}

Result<kz_statistics_reply> Robot::board_statistics() {
  return parts_->ask(KZ_TYPE_statistics, kz_statistics{}, kz_pack_statistics,
                     kz_unpack_statistics_reply);
}

std::optional<Posture> Robot::posture_at(Time t) const {
  return parts_->history.at(t);
}
std::optional<Time> Robot::newest_posture() const {
  return parts_->history.newest();
}
Time Robot::clock_error() const {
  return parts_->relation.error_bound();
}
const LinkStatistics& Robot::statistics() const {
  return parts_->requester.statistics();
}
std::string Robot::recent_frames() const {
  return parts_->requester.frames().text();
}

void Robot::disable_all() noexcept {
  if (!parts_) return;
  try {
    const Request off = make_request(KZ_TYPE_enable, kz_enable{0}, kz_pack_enable);
    if (parts_->requester.ask({&off, 1})) return;
    // Nobody listens here any more (interrupted, or the board is deaf), but the wire may still
    // carry it.
    for (int i = 0; i < 3; ++i) (void)parts_->requester.tell(off);
  } catch (...) {
    // Out of memory: the board's link watchdog does it.
  }
}

}  // namespace kaz::host
