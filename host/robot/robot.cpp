// Robot: connecting, moving, and the end.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/robot.h"

#include <algorithm>

#include "host/robot/connect.h"
#include "host/robot/find_boards.h"
#include "host/robot/robot_parts.h"

namespace kaz::host {

namespace {

Result<Request> targets_request(std::span<const JointTarget> targets, Time duration) {
  kz_targets message{};
  const auto duration_ms = to_wire<u16>(seconds(duration) * 1e3);
  if (!duration_ms) return fail(Fault::usage, "a target's duration must be 0 to 65 s");
  message.duration_ms = *duration_ms;
  for (const JointTarget& target : targets) {
    KAZ_TRY(check_joint(target.joint));
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

Request inertial_request() {
  return make_request(KZ_TYPE_inertial, kz_inertial{}, kz_pack_inertial);
}

}  // namespace

Robot::Robot(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Robot::Robot(Robot&&) noexcept = default;
Robot& Robot::operator=(Robot&&) noexcept = default;
Robot::~Robot() = default;

Result<Robot> Robot::connect(Link& link, Clock& clock, const ConnectOptions& options) {
  const RobotBoard board{&link, options.address, kAllJoints};
  return connect({&board, 1}, clock, options);
}

Result<Robot> Robot::connect(std::span<const RobotBoard> boards, Clock& clock,
                             const ConnectOptions& options) {
  KAZ_TRY(check_boards(boards));
  const auto watchdog_10ms = to_wire<u8>(seconds(options.watchdog) * 100);
  if (!watchdog_10ms || *watchdog_10ms > 100) {
    return fail(Fault::usage, "the link watchdog's limit must be 10 ms to 1 s");
  }
  auto parts = std::make_unique<Parts>(boards, clock, options);
  if (auto found = identify_board(parts->requester); !found) {
    parts->frames_at_loss =
        parts->requester.statistics().bytes_in ? parts->requester.recent_frames() : std::string();
    Error error = parts->for_good(found.error());
    if (parts->requester.timed_out() && boards.size() == 1)
      error = explain_silence(*boards.front().link, clock, boards.front().address, std::move(error),
                              options.address_advice);
    return tl::unexpected(std::move(error));
  }
  // Once more: this answer also relates the clocks.
  const auto identity =
      parts->query(KZ_TYPE_identify, kz_identify{}, kz_pack_identify, kz_unpack_identify_reply);
  if (!identity) return tl::unexpected(identity.error());
  parts->identity = *identity;
  Robot robot(std::move(parts));
  if (*watchdog_10ms != 0) {
    KAZ_TRY(robot.heartbeat(options.watchdog, options.reaction));
  }
  KAZ_TRY(robot.lower_ramps());
  return robot;
}

const kz_identify_reply& Robot::identity() const {
  return parts_->identity;
}
Clock& Robot::clock() {
  return parts_->keeping_clock;
}

Result<void> Robot::enable(std::uint32_t mask) {
  // Which motors are on is unknown until the reply; if the link is lost meanwhile, the request below is
  // repeated, not restore()'s.
  parts_->on = 0;
  if (mask != 0) {
    if (auto cleared = clear(); !cleared) return cleared;
  }
  const Request request = make_request(KZ_TYPE_enable, kz_enable{mask}, kz_pack_enable);
  const auto replies = parts_->exchange({&request, 1}, AfterLoss::repeat);
  if (!replies) return tl::unexpected(replies.error());
  const auto reply = read_reply(replies->front(), kz_unpack_enable_reply);
  if (!reply) return tl::unexpected(parts_->with_joints(reply.error(), replies->front()));
  if (reply->mask != mask) {
    const auto faults = fault_sentence(reply->status);
    const std::string off = parts_->names_of(mask & ~reply->mask);
    std::string why = parts_->still_on(reply->mask & ~mask, 0);
    if (!why.empty()) why += "; cut their power";
    if (!off.empty()) why += (why.empty() ? "" : "; ") + ("still off: " + off);
    return fail(shutdown_fault(reply->status),
                "the board did not switch the motors as requested: " + why +
                    (faults ? "; " + *faults : std::string()));
  }
  parts_->on = mask;
  return {};
}

Result<void> Robot::set_targets(std::span<const JointTarget> targets, Time duration) {
  const auto request = KAZ_TRY(targets_request(targets, duration));
  const auto replies = parts_->exchange({&request, 1}, AfterLoss::report);
  if (!replies) return tl::unexpected(replies.error());
  const auto reply = read_reply(replies->front(), kz_unpack_targets_reply, targets);
  if (!reply) return tl::unexpected(parts_->with_limits(reply.error(), replies->front(), targets));
  return {};
}

Result<Posture> Robot::state() {
  const Request requests[] = {state_request(), inertial_request()};
  const auto replies = parts_->exchange({requests, parts_->inertial ? 2u : 1u}, AfterLoss::repeat);
  if (!replies) return tl::unexpected(replies.error());
  return parts_->take_sensed((*replies)[0], parts_->inertial ? &(*replies)[1] : nullptr);
}

Result<bool> Robot::sense_inertial() {
  const Request request = inertial_request();
  const auto replies = parts_->exchange({&request, 1}, AfterLoss::repeat);
  if (!replies) return tl::unexpected(replies.error());
  parts_->inertial = false;
  if (replies->front().refused) return false;  // firmware of before there was such a request
  const auto codes = KAZ_TRY(read_reply(replies->front(), kz_unpack_inertial_reply));
  parts_->inertial = std::max({codes.yaw_rate, codes.forward, codes.left}) >= kNotFitted;
  return parts_->inertial;
}

Result<Posture> Robot::Parts::take_sensed(const Reply& state, const Reply* motion) {
  auto posture = take_state(state);
  if (!posture || !motion) return posture;
  const auto codes = KAZ_TRY(read_reply(*motion, kz_unpack_inertial_reply));
  // A code stands for the middle of what the converter rounds down to it.
  const auto from_middle = [](unsigned code) { return code + 0.5 - KZ_POT_CODES / 2; };
  posture->inertial = {.time = relation.host_time(codes.tick),
                       .yaw_rate_rad_per_s = from_middle(codes.yaw_rate) * kYawRatePerCode,
                       .forward_m_per_s2 = from_middle(codes.forward) * kForcePerCode,
                       .left_m_per_s2 = from_middle(codes.left) * kForcePerCode};
  return posture;
}

Result<Posture> Robot::exchange(std::span<const JointTarget> targets, Time duration) {
  if (targets.empty()) return state();
  const auto move = KAZ_TRY(targets_request(targets, duration));
  const Request requests[] = {move, state_request(), inertial_request()};
  const bool inertial = parts_->inertial;
  const auto replies = parts_->exchange({requests, inertial ? 3u : 2u}, AfterLoss::report);
  if (!replies) {
    if (parts_->resumed) return state();
    return tl::unexpected(replies.error());
  }
  return parts_->take_cycle(&(*replies)[0], (*replies)[1], targets,
                            inertial ? &(*replies)[2] : nullptr);
}

Result<Posture> Robot::Parts::take_cycle(const Reply* move, const Reply& state,
                                         std::span<const JointTarget> targets,
                                         const Reply* motion) {
  auto posture = take_sensed(state, motion);
  if (!move) return posture;
  if (const auto taken = read_reply(*move, kz_unpack_targets_reply, targets); !taken) {
    // Why the targets were refused the state may tell better.
    if (posture && (posture->status & kMotorsOffFaults)) {
      return fail(shutdown_fault(posture->status), describe_fault(posture->status));
    }
    return tl::unexpected(with_limits(taken.error(), *move, targets));
  }
  return posture;
}

Result<void> Robot::send_cycle(std::span<const JointTarget> targets, Time duration) {
  Parts::Cycle cycle;
  std::vector<Request> requests;
  if (!targets.empty()) {
    const auto move = KAZ_TRY(targets_request(targets, duration));
    requests.push_back(move);
  }
  requests.push_back(state_request());
  for (const Request& request : requests) {
    const auto ticket = parts_->requester.post(request);
    if (!ticket) {
      auto found = parts_->resume(&ticket.error());
      parts_->found_again = found.has_value();
      return found;
    }
    (request.type == KZ_TYPE_targets ? cycle.move : cycle.state) = *ticket;
  }
  cycle.targets.assign(targets.begin(), targets.end());
  parts_->cycles.push_back(std::move(cycle));
  return {};
}

Result<std::optional<Posture>> Robot::receive_cycle(Time deadline) {
  if (parts_->found_again) {
    parts_->found_again = false;
    return state();
  }
  if (parts_->cycles.empty())
    return fail(Fault::usage, "receive_cycle: no sent cycle is pending; call send_cycle first");
  Parts::Cycle& cycle = parts_->cycles.front();
  const auto collect = [&](std::optional<Exchanger::Ticket> ticket, std::optional<Reply>& reply,
                           std::uint8_t type) -> Result<void> {
    if (!ticket || reply) return {};
    auto collected = KAZ_TRY(parts_->requester.collect(*ticket, deadline));
    reply = std::move(collected);
    if (reply) parts_->observe(type, *reply);
    return {};
  };
  parts_->link_fault.reset();
  auto done = collect(cycle.move, cycle.move_reply, KZ_TYPE_targets);
  if (done && (!cycle.move || cycle.move_reply)) {
    done = collect(cycle.state, cycle.state_reply, KZ_TYPE_state);
  }
  if (!done || (parts_->link_fault && parts_->options.reconnect != Time::zero())) {
    auto found = parts_->resume(done ? nullptr : &done.error());
    if (!found) return tl::unexpected(found.error());
    parts_->found_again = false;
    return state();
  }
  if (!cycle.state_reply) return std::nullopt;
  const Parts::Cycle whole = std::move(cycle);
  parts_->cycles.pop_front();
  return parts_->take_cycle(whole.move_reply ? &*whole.move_reply : nullptr, *whole.state_reply,
                            whole.targets);
}

std::optional<Resumption> Robot::take_resumption() {
  if (parts_->resumptions.empty()) return std::nullopt;
  const Resumption oldest = parts_->resumptions.front();
  parts_->resumptions.pop_front();
  return oldest;
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
  return parts_->requester.recent_frames();
}

Result<void> Robot::disable_all() noexcept {
  constexpr int kTries = 3;  // a bus asks its servos anew each time
  if (!parts_) return {};
  try {
    parts_->on = 0;
    parts_->requester.start_anew();
    const Request off = make_request(KZ_TYPE_enable, kz_enable{0}, kz_pack_enable);
    std::string why;
    for (int tries = 0; tries < kTries; ++tries) {
      const auto replies = parts_->requester.exchange({&off, 1});
      const auto reply = replies ? read_reply(replies->front(), kz_unpack_enable_reply)
                                 : tl::unexpected(replies.error());
      why = reply ? parts_->still_on(reply->mask, reply->status) : reply.error().message;
      if (why.empty()) return {};
      if (replies) continue;
      // Nobody listens here any more (interrupted, or the board is deaf), but the wire may still
      // carry it.
      for (int i = 0; i < kTries; ++i) (void)parts_->requester.send(off);
      break;
    }
    return fail(Fault::environment, "no reply confirms that the motors on " +
                                        parts_->requester.link().name() + " are off (" + why +
                                        "): cut their power");
  } catch (...) {
    // Out of memory: the board's link watchdog does it.
    return tl::unexpected(Error());
  }
}

}  // namespace kaz::host
