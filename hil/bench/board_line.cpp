// Requests, streams and loads of the bench.
// SPDX-License-Identifier: Apache-2.0
#include "hil/bench/board_line.h"

#include <algorithm>

#include "host/link/lateness.h"
#include "host/robot/connect.h"
#include "shared/protocol/bytes.h"

namespace kaz::hil {
namespace {

constexpr double kTickShare = 8.0 / KZ_STATES_PER_TICK;  // of a tick, in 8 states
constexpr std::size_t kCyclesAhead = 3;                  // keep the window full
// A bad link is to be measured, not given up.
constexpr int kRetries = 20;
// A frame may contain an earlier tick than the previous one; much earlier, if this program was stopped for a
// while, and what came meanwhile is read in another order. But none from before the measurement.
constexpr std::int32_t kOutOfOrderMs = 50, kStoppedMs = 2000;
constexpr int kTriesToFind = 6, kTriesAtEnd = 3;
constexpr Time kHeartbeat = std::chrono::milliseconds(25);
constexpr u8 kWatchdog10ms = 10;  // of the board: whoever was here before may have set it shorter

host::RequesterOptions options_for(std::uint8_t address) {
  host::RequesterOptions options;
  options.address = address;
  options.retries = kRetries;
  return options;
}

}  // namespace

BoardLine::BoardLine(host::Link& link, host::Clock& clock, std::uint8_t address)
    : link_(link), clock_(clock), requester_(link, clock, options_for(address)) {
  requester_.on_telemetry([this](std::uint8_t type, std::span<const std::uint8_t> fields, Time at) {
    take(type, fields, at);
  });
}

Result<void> BoardLine::measure(const std::string& what,
                                const std::function<Result<void>()>& measure) {
  if (auto begun = begin(); !begun) return begun;
  auto ran = measure();
  end();
  if (ran && was_reset_)
    return fail(Fault::environment, "the board was reset during the " + what + " measurement");
  return ran;
}

Result<void> BoardLine::begin() {
  requester_.limit_tries(kTriesToFind);
  const auto identity = host::identify_board(requester_);
  requester_.limit_tries(std::nullopt);
  if (!identity) return tl::unexpected(identity.error());
  identity_ = *identity;
  last_tick_ = identity_.tick;
  if (identity_.status & KZ_STATUS_ENABLED) {
    return fail(Fault::environment, "the board at " + link_.name() +
                                        " has motors that are on: switch the motors off first");
  }
  const auto heard = query(KZ_TYPE_heartbeat, kz_heartbeat{kWatchdog10ms, 0}, kz_pack_heartbeat,
                           kz_unpack_heartbeat_reply);
  if (!heard) return tl::unexpected(heard.error());
  if (!can_stream()) return {};
  const auto none = stream(0, 0);
  return none ? Result<void>() : tl::unexpected(none.error());
}

void BoardLine::end() noexcept {
  requester_.start_anew();
  requester_.limit_tries(kTriesAtEnd);
  if (on_ && !enable(false)) {
    // Nobody listens here any more (interrupted, or the board is deaf), but the wire may carry it.
    const host::Request off = host::make_request(KZ_TYPE_enable, kz_enable{0}, kz_pack_enable);
    for (int i = 0; i < kTriesAtEnd; ++i) (void)requester_.send(off);
  }
  if (streaming_) (void)stream(0, 0);
  if (identity_.status >> 8 == KZ_SHUTDOWN_NONE) (void)clear_link_lost();
}

Result<bool> BoardLine::clear_link_lost() {
  const auto now = KAZ_TRY(statistics());
  if (now.status >> 8 != KZ_SHUTDOWN_LINK_LOST) return false;
  KAZ_TRY(query(KZ_TYPE_clear, kz_clear{}, kz_pack_clear, kz_unpack_clear_reply));
  on_ = false;
  return true;
}

Result<void> BoardLine::with_joints_on(const std::function<Result<void>()>& load) {
  for (int run = 0; run <= host::LatenessMeter::kRepetitions; ++run) {
    KAZ_TRY(enable(true));
    KAZ_TRY(load());
    if (!KAZ_TRY(clear_link_lost())) return enable(false);
  }
  return fail(Fault::environment,
              "the board on " + link_.name() + " switched its motors off in each of " +
                  std::to_string(host::LatenessMeter::kRepetitions + 1) +
                  " runs because no request reached the board for 100 ms: either this machine is "
                  "too busy, or the connection to the board was interrupted; end other programs "
                  "and try again");
}

bool BoardLine::can_stream() const {
  return (identity_.capabilities & KZ_CAPABILITY_TELEMETRY) != 0;
}

Result<kz_statistics_reply> BoardLine::statistics() {
  return query(KZ_TYPE_statistics, kz_statistics{}, kz_pack_statistics, kz_unpack_statistics_reply);
}

Result<kz_state_reply> BoardLine::state() {
  return query(KZ_TYPE_state, kz_state{}, kz_pack_state, kz_unpack_state_reply);
}

Result<std::uint32_t> BoardLine::stream(int period_ms, std::uint8_t selection) {
  const kz_telemetry message{static_cast<u16>(period_ms), selection};
  const auto reply =
      KAZ_TRY(query(KZ_TYPE_telemetry, message, kz_pack_telemetry, kz_unpack_telemetry_reply));
  streaming_ = period_ms != 0;
  return reply.tick;
}

Result<void> BoardLine::listen_until(Time t) {
  while (clock_.now() < t) {
    const Time heartbeat_due = requester_.last_sent() + kHeartbeat;
    // Where no frame comes the heartbeat is not waited for longer than this.
    const Time overdue = heartbeat_due + kHeartbeat;
    const auto came = requester_.listen(std::min(t, overdue));
    if (!came) return tl::unexpected(came.error());
    if (clock_.now() < heartbeat_due || clock_.now() >= t) continue;
    const auto heard =
        query(KZ_TYPE_heartbeat, kz_heartbeat{}, kz_pack_heartbeat, kz_unpack_heartbeat_reply);
    if (!heard) return tl::unexpected(heard.error());
  }
  return {};
}

std::vector<Arrival> BoardLine::take_arrivals() {
  return std::exchange(arrivals_, {});
}

Result<void> BoardLine::enable(bool on) {
  on_ = true;  // assumed until the board reports otherwise
  const auto reply = query(KZ_TYPE_enable, kz_enable{on ? u32{KZ_ALL_JOINTS} : 0}, kz_pack_enable,
                           kz_unpack_enable_reply);
  if (!reply) return tl::unexpected(reply.error());
  on_ = on;
  return {};
}

void BoardLine::observe(const host::Reply& reply) {
  if (reply.fields.length >= sizeof(u32)) observe_tick(kz_get_u32(reply.fields.bytes.data()));
}

void BoardLine::observe_tick(std::uint32_t tick) {
  const auto since = [tick](std::uint32_t other) {
    return static_cast<std::int32_t>(tick - other);
  };
  if (since(last_tick_) < -kStoppedMs ||
      (since(last_tick_) < -kOutOfOrderMs && since(identity_.tick) < -kOutOfOrderMs))
    was_reset_ = true;
  last_tick_ = tick;
}

void BoardLine::take(std::uint8_t type, std::span<const std::uint8_t> fields, Time at) {
  Arrival arrival;
  arrival.type = type;
  arrival.at = at;
  const auto length = static_cast<u8>(fields.size());
  if (type == KZ_TYPE_telemetry_health) {
    kz_telemetry_health health{};
    if (!kz_unpack_telemetry_health(&health, fields.data(), length)) return;
    arrival.tick = health.tick;
    arrival.busy = health.busy_8states * kTickShare;
    arrival.worst = health.worst_8states * kTickShare;
  } else if (type == KZ_TYPE_telemetry_state) {
    kz_telemetry_state state{};
    if (!kz_unpack_telemetry_state(&state, fields.data(), length)) return;
    arrival.tick = state.tick;
  } else {
    return;
  }
  observe_tick(arrival.tick);
  arrivals_.push_back(arrival);
}

CycleLoad::CycleLoad(BoardLine& line, const kz_state_reply& state,
                     std::function<void(double)> progress)
    : line_(line), progress_(std::move(progress)) {
  kz_targets targets{};
  targets.mask = KZ_ALL_JOINTS;
  std::copy(std::begin(state.angle), std::end(state.angle), std::begin(targets.angle));
  targets_ = host::make_request(KZ_TYPE_targets, targets, kz_pack_targets);
  state_ = host::make_request(KZ_TYPE_state, kz_state{}, kz_pack_state);
}

Result<void> CycleLoad::send() {
  const auto targets = KAZ_TRY(line_.requester().post(targets_));
  const auto state = KAZ_TRY(line_.requester().post(state_));
  under_way_.push_back({targets, state});
  return {};
}

// A cycle's targets are answered before its state: the board answers in order.
Result<bool> CycleLoad::receive(Time deadline) {
  const Cycle oldest = under_way_.front();
  const auto state = KAZ_TRY(line_.requester().collect(oldest.state, deadline));
  if (!state) return false;
  line_.observe(*state);
  const auto targets = line_.requester().collect(oldest.targets, Time::max());
  if (!targets) return tl::unexpected(targets.error());
  under_way_.erase(under_way_.begin());
  ++cycles_;
  report_progress();
  return true;
}

void CycleLoad::report_progress() {
  constexpr int kCyclesBetween = 32;
  if (!progress_ || cycles_ % kCyclesBetween != 0) return;
  progress_(std::min(1.0, seconds(line_.clock().now() - start_) / seconds(end_ - start_)));
}

Result<void> CycleLoad::run(double rate_hz, Time end) {
  start_ = line_.clock().now();
  end_ = end;
  if (auto ran = rate_hz > 0 ? run_paced(from_seconds(1 / rate_hz), end) : run_fast(end); !ran) {
    return ran;
  }
  while (!under_way_.empty()) {
    KAZ_TRY(receive(Time::max()));
  }
  seconds_ = seconds(line_.clock().now() - start_);
  return {};
}

Result<void> CycleLoad::run_fast(Time end) {
  while (line_.clock().now() < end) {
    while (under_way_.size() < kCyclesAhead) {
      if (auto sent = send(); !sent) return sent;
    }
    KAZ_TRY(receive(Time::max()));
  }
  return {};
}

// A cycle is skipped if the link is too slow.
Result<void> CycleLoad::run_paced(Time period, Time end) {
  host::Clock& clock = line_.clock();
  for (Time next = clock.now() + period; clock.now() < end; next += period) {
    if (under_way_.size() < kCyclesAhead) {
      if (auto sent = send(); !sent) return sent;
    }
    while (clock.now() < next && !under_way_.empty()) {
      KAZ_TRY(receive(next));
    }
    if (auto slept = clock.sleep_until(next); !slept) return slept;
  }
  return {};
}

double CycleLoad::rate_hz() const {
  return seconds_ > 0 ? cycles_ / seconds_ : 0;
}

}  // namespace kaz::hil
