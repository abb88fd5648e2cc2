// Requests of Robot: sent, replies observed, repeated after a reconnection.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/robot_parts.h"

#include "host/link/requester.h"
#include "host/robot/board_group.h"

namespace kaz::host {

namespace {

// Replies stand in the order of the board's ticks; telemetry and a reply may be a tick apart.
constexpr std::int32_t kTickSlack = 5;

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

std::unique_ptr<Exchanger> make_requester(std::span<const RobotBoard> boards, Clock& clock,
                                          int retries) {
  const RobotBoard& first = boards.front();
  if (boards.size() == 1)
    return std::make_unique<Requester>(
        *first.link, clock, RequesterOptions{.address = first.address, .retries = retries});
  return std::make_unique<BoardGroup>(std::vector(boards.begin(), boards.end()), clock, retries);
}

}  // namespace

Result<void> check_joint(int joint) {
  if (joint >= 0 && joint < KZ_JOINTS) return {};
  return fail(Fault::usage,
              "joint " + std::to_string(joint) + ": must be 0 to " + std::to_string(KZ_JOINTS - 1));
}

Result<void> check_mask(std::uint32_t mask) {
  if (mask != 0 && (mask & ~kAllJoints) == 0) return {};
  return fail(Fault::usage,
              "a mask of joints must have at least one bit set, and only bits from 0 to " +
                  std::to_string(KZ_JOINTS - 1));
}

Robot::Parts::Parts(std::span<const RobotBoard> boards, Clock& on_clock,
                    const ConnectOptions& connect_options)
    : options(connect_options),
      clock(on_clock),
      keeping_clock(*this),
      owned_requester(make_requester(boards, on_clock, connect_options.retries)),
      requester(*owned_requester),
      relation(boards.front().link->byte_time()) {
  requester.on_telemetry([this](std::uint8_t type, std::span<const std::uint8_t> fields, Time now) {
    take_telemetry(type, fields, now);
  });
}

Result<std::vector<Reply>> Robot::Parts::exchange(std::span<const Request> requests,
                                                  AfterLoss after_loss) {
  resumed = false;
  while (true) {
    link_fault.reset();
    auto replies = requester.exchange(requests);
    if (replies) {
      for (std::size_t i = 0; i < requests.size(); ++i) observe(requests[i].type, (*replies)[i]);
      if (!link_fault || options.reconnect == Time::zero()) return replies;
    }
    const bool before = resumed;
    KAZ_TRY(resume(replies ? nullptr : &replies.error()));
    if (before || after_loss == AfterLoss::report) return tl::unexpected(not_done(requests));
  }
}

void Robot::Parts::observe(std::uint8_t request, const Reply& reply) {
  // Replies begin with tick and status; identify's has the protocol version in between.
  const std::size_t status_at = !reply.refused && request == KZ_TYPE_identify ? 6 : 4;
  if (reply.fields.length < status_at + 2) return;
  const std::uint32_t tick = big_endian({reply.fields.bytes.data(), 4});
  const auto status =
      static_cast<std::uint16_t>(big_endian({reply.fields.bytes.data() + status_at, 2}));
  if (reply.timed) {
    relation.add({reply.sent, reply.received, reply.bytes_out, reply.bytes_in, tick});
  }

  const bool back = requester.take_restart() ||
                    (last_tick && static_cast<std::int32_t>(tick - *last_tick) < -kTickSlack);
  last_tick = tick;
  const int reason = status >> 8;
  if (back || (on != 0 && reason == KZ_SHUTDOWN_NONE && !(status & KZ_STATUS_ENABLED))) {
    link_fault = Resumption::Cause::reset;
  } else if (on != 0 && reason == KZ_SHUTDOWN_LINK_LOST) {
    if (!link_fault) link_fault = Resumption::Cause::watchdog;
  } else if (reason != KZ_SHUTDOWN_NONE) {
    on = 0;
  }
}

Result<Posture> Robot::Parts::take_state(const Reply& reply) {
  const auto state = KAZ_TRY(read_reply(reply, kz_unpack_state_reply));
  Posture posture;
  posture.time = relation.host_time(state.tick);
  posture.tick = state.tick;
  posture.status = state.status;
  posture.supply_volts = state.supply_mv * 1e-3;
  for (std::size_t j = 0; j < posture.angle.size(); ++j)
    posture.angle[j] = angle_of(state.angle[j]);
  history.add(posture);
  return posture;
}

Error Robot::Parts::not_done(std::span<const Request> requests) const {
  std::string names;
  for (const Request& request : requests) {
    names += (names.empty() ? "`" : ", `") + std::string(message_name(request.type)) + "`";
  }
  const std::string why =
      resumptions.empty() ? "the link was lost" : text(resumptions.back().cause);
  return {Fault::environment,
          why + " during " + names +
              ": the board answers again, and enabled joints hold their position; the request may "
              "not have been executed, so send the request again"};
}

}  // namespace kaz::host
