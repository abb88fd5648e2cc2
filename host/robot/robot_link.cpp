// A lost link: finding the board again, and putting it back where it was, motors still.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <utility>

#include "host/robot/connect.h"
#include "host/robot/robot_parts.h"
#include "shared/base/files.hpp"
#include "shared/protocol/message_info.h"

namespace kaz::host {

namespace {

constexpr Time kBetweenAttempts = std::chrono::milliseconds(20);
constexpr int kTriesEach = 2;
// Three heartbeats in the watchdog's time: one may be lost, and its repetition late.
constexpr int kHeartbeatsPerWatchdog = 3;

Error in_vain(const std::string& loss, Time sought, const Error& last) {
  char time[64];
  std::snprintf(time, sizeof time, "; the board was not found again within %.1f s",
                seconds(sought));
  return {last.fault, loss + time + (last.message == loss ? "" : ": " + last.message)};
}

}  // namespace

const char* text(Resumption::Cause cause) {
  switch (cause) {
    case Resumption::Cause::watchdog:
      return "the board received no request within its watchdog's limit";
    case Resumption::Cause::reset:
      return "the board was reset";
    default:
      return "the link was lost";
  }
}

Result<void> Robot::Parts::resume(const Error* error) {
  const Time lost = clock.now();
  frames_at_loss = requester.recent_frames();
  // An interrupt, and whatever else is no fault of the environment, stays what it is.
  if (error && error->fault != Fault::environment) return tl::unexpected(*error);
  if (options.reconnect == Time::zero()) return tl::unexpected(for_good(*error));
  bool reopen = error && !requester.timed_out();
  Resumption resumption{link_fault.value_or(Resumption::Cause::link), lost, lost};
  const std::optional<std::uint32_t> tick_before = last_tick;
  cycles.clear();
  const auto report_loss = [&](const Error& why) {
    if (std::exchange(resumption.reported, true) || !options.on_lost) return;
    options.on_lost({resumption.cause, lost, options.reconnect, why.message});
  };
  if (error) report_loss(*error);

  while (true) {
    requester.start_anew();
    Result<void> done = reopen ? requester.link().reopen() : Result<void>();
    if (done) done = restore();
    if (done) break;
    if (done.error().fault != Fault::environment) return tl::unexpected(done.error());
    report_loss(done.error());
    if (clock.now() - lost >= options.reconnect) {
      return tl::unexpected(for_good(in_vain(error ? error->message : text(resumption.cause),
                                             clock.now() - lost, done.error())));
    }
    reopen = !requester.timed_out();
    if (auto slept = clock.sleep_until(clock.now() + kBetweenAttempts); !slept) return slept;
  }
  if (tick_before && last_tick && static_cast<std::int32_t>(*last_tick - *tick_before) < 0) {
    resumption.cause = Resumption::Cause::reset;
  }
  resumption.resumed = clock.now();
  resumptions.push_back(resumption);
  if (options.on_resumed) options.on_resumed(resumption);
  link_fault.reset();
  resumed = true;
  return {};
}

// Uses the requester directly: if the link is lost again meanwhile, the caller makes a further attempt.
Result<void> Robot::Parts::restore() {
  requester.limit_tries(kTriesEach);
  auto found = identify_board(requester);
  requester.limit_tries(std::nullopt);
  if (!found) return tl::unexpected(found.error());
  identity = *found;
  last_tick = identity.tick;
  const int reason = identity.status >> 8;
  if (on != 0 && reason != KZ_SHUTDOWN_NONE && reason != KZ_SHUTDOWN_LINK_LOST) {
    on = 0;
    return fail(Fault::failed, *fault_sentence(identity.status));
  }
  if (auto set = set_up(); !set) return set;
  if (telemetry_on) {
    const Request again = make_request(KZ_TYPE_telemetry, telemetry_request, kz_pack_telemetry);
    if (auto replies = requester.exchange({&again, 1}); !replies)
      return tl::unexpected(replies.error());
  }
  return on != 0 ? switch_on(on) : Result<void>();
}

Result<void> Robot::Parts::set_up() {
  std::vector<Request> requests;
  if (watchdog_10ms != 0 || reaction != 0) {
    requests.push_back(
        make_request(KZ_TYPE_heartbeat, kz_heartbeat{watchdog_10ms, reaction}, kz_pack_heartbeat));
  }
  // Joints that were given the same share a mask: one request for the lowest of them.
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const u32 lower = (u32{1} << j) - 1;
    if (gains[j] && !(gains[j]->mask & lower)) {
      requests.push_back(make_request(KZ_TYPE_gains, *gains[j], kz_pack_gains));
    }
    if (limits[j] && !(limits[j]->mask & lower)) {
      requests.push_back(make_request(KZ_TYPE_limits, *limits[j], kz_pack_limits));
    }
  }
  const auto replies = KAZ_TRY(requester.exchange(requests));
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const Reply& reply = replies[i];
    if (reply.refused) return tl::unexpected(read_reply(reply, kz_unpack_refused).error());
    last_tick = std::nullopt;
    observe(requests[i].type, reply);
  }
  return {};
}

Result<void> Robot::Parts::switch_on(std::uint32_t mask) {
  for (const Request& request : {make_request(KZ_TYPE_clear, kz_clear{}, kz_pack_clear),
                                 make_request(KZ_TYPE_enable, kz_enable{mask}, kz_pack_enable)}) {
    const auto replies = requester.exchange({&request, 1});
    if (!replies) return tl::unexpected(replies.error());
    if (replies->front().refused) {
      const auto refusal = read_reply(replies->front(), kz_unpack_refused);
      Error error = with_joints(refusal.error(), replies->front());
      // What a board that starts measures may be out of range for a while: it is tried again.
      error.fault = Fault::environment;
      return tl::unexpected(std::move(error));
    }
  }
  return {};
}

Error Robot::Parts::for_good(Error error) {
  if (options.frames_path.empty() || frames_at_loss.empty()) return error;
  if (options.frames_path == "-") {
    std::fprintf(stderr, "the last frames:\n%s", frames_at_loss.c_str());
    return error;
  }
  if (write_whole_file(options.frames_path, frames_at_loss))
    error.message += "; the last frames are in " + options.frames_path;
  return error;
}

Time Robot::Parts::heartbeat_period() const {
  const int limit = watchdog_10ms != 0 ? watchdog_10ms : identity.watchdog_10ms;
  return std::chrono::milliseconds(10) * limit / kHeartbeatsPerWatchdog;
}

Result<void> Robot::Parts::keep_content(Time until) {
  const Time period = heartbeat_period();
  while (clock.now() < until) {
    if (period == Time::zero() || (on == 0 && !telemetry_on)) return clock.sleep_until(until);
    const Time next = requester.last_sent() + period;
    if (auto slept = clock.sleep_until(std::min(until, std::max(next, clock.now()))); !slept) {
      return slept;
    }
    if (clock.now() >= until || clock.now() < next) continue;
    const auto heard =
        query(KZ_TYPE_heartbeat, kz_heartbeat{}, kz_pack_heartbeat, kz_unpack_heartbeat_reply);
    if (!heard) return tl::unexpected(heard.error());
  }
  return {};
}

Result<void> Robot::Parts::KeepingClock::sleep_until(Time t) {
  return parts_.keep_content(t);
}

}  // namespace kaz::host
