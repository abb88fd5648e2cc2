// Window, order, repetitions.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/requester.h"

#include <algorithm>
#include <cstdio>

#include "shared/protocol/bytes.h"
#include "shared/protocol/message_info.h"

namespace kaz::host {

namespace {

constexpr std::size_t kNoiseKept = 64;
constexpr Time kBusyPause = std::chrono::milliseconds(2);
constexpr Time kBusyPatience = std::chrono::milliseconds(500);
constexpr Time kUsualByte = std::chrono::nanoseconds(10'000'000'000 / KZ_BAUD);
constexpr int kFrameOverhead = KZ_FRAME_MAX - KZ_BODY_MAX;
constexpr std::uint8_t kSequenceLeap = 0x55;
constexpr std::size_t kSequencesApart = 16;  // a board remembers 4 requests

constexpr std::uint8_t reply_type(std::uint8_t request) {
  return request | KZ_REPLY;
}

// Whether a request can only take power from motors, so that executing it twice does no harm.
bool only_switches_off(const Request& request) {
  const auto zero = [&](std::size_t first, std::size_t count) {
    return std::all_of(request.fields.bytes.begin() + first,
                       request.fields.bytes.begin() + first + count,
                       [](std::uint8_t byte) { return byte == 0; });
  };
  switch (request.type) {
    case KZ_TYPE_stop:
      return true;
    case KZ_TYPE_enable:
      return zero(0, 4);  // mask
    case KZ_TYPE_unlock:
      return zero(2, 1);  // seconds, behind the key
    case KZ_TYPE_raw_drive:
      return zero(1, 2);  // duty, behind the joint
    default:
      return false;
  }
}

// Whether the reply to a request that switches all motors off says that one is on.
bool motors_stay_on(const Request& request, std::span<const std::uint8_t> reply) {
  constexpr std::size_t kStatusAt = 4;  // behind the tick
  const bool all = request.type == KZ_TYPE_stop || request.type == KZ_TYPE_enable;
  return all && only_switches_off(request) && reply.size() >= kStatusAt + 2 &&
         (kz_get_u16(reply.data() + kStatusAt) & KZ_STATUS_ENABLED) != 0;
}

}  // namespace

struct Requester::Waiting {
  Ticket ticket = 0;
  Request request;
  std::vector<std::uint8_t>
      sequences;  // of its transmissions; more than one if it only switches off
  bool at_once = false, done = false;
  bool busy = false;  // refused for want of room
  bool lost = false;  // what was sent behind it is answered
  int tries = 0, unanswered = 0;
  std::uint64_t transmission = 0;  // number of the latest
  Time first{}, sent{}, deadline{};
  int bytes_out = 0;
  Reply reply;

  bool under_way() const { return tries > 0 && !done; }
};

Requester::Requester(Link& link, Clock& clock, const RequesterOptions& options)
    : link_(link),
      clock_(clock),
      options_(options),
      byte_time_(link.byte_time() > Time::zero() ? link.byte_time() : kUsualByte),
      // Differs from one program run to the next, so that a board does not take a new request for
      // the repetition of an old one; in simulated time it is the same in each run.
      next_sequence_(static_cast<std::uint8_t>(clock.now().count() >> 10)),
      round_trip_(options.timeout) {
  kz_receiver_init(&receiver_);
}

Requester::~Requester() = default;

Result<std::vector<Reply>> Requester::exchange(std::span<const Request> requests) {
  std::vector<Ticket> tickets;
  for (const Request& request : requests) tickets.push_back(enqueue(request, false));
  KAZ_TRY(send_waiting());
  std::vector<Reply> replies;
  for (const Ticket ticket : tickets) {
    auto reply = KAZ_TRY(collect(ticket, Time::max()));
    replies.push_back(std::move(*reply));
  }
  return replies;
}

Result<Requester::Ticket> Requester::post(const Request& request) {
  const Ticket ticket = enqueue(request, false);
  KAZ_TRY(send_waiting());
  return ticket;
}

Result<Reply> Requester::exchange_at_once(const Request& request) {
  const Ticket ticket = enqueue(request, true);
  KAZ_TRY(send_waiting());
  auto reply = KAZ_TRY(collect(ticket, Time::max()));
  return std::move(*reply);
}

Result<std::optional<Reply>> Requester::collect(Ticket ticket, Time deadline) {
  timed_out_ = false;
  bool late = false;
  while (true) {
    const auto waiting = std::find_if(queue_.begin(), queue_.end(),
                                      [&](const Waiting& w) { return w.ticket == ticket; });
    if (waiting == queue_.end()) {
      return fail(Fault::failed, "the reply was discarded when the link to the board on " +
                                     link_.name() + " failed");
    }
    if (waiting->done) {
      Reply reply = std::move(waiting->reply);
      queue_.erase(waiting);
      return reply;
    }
    if (late) return std::nullopt;
    KAZ_TRY(pump(deadline));
    late = clock_.now() >= deadline;
  }
}

Result<bool> Requester::listen(Time deadline) {
  const std::uint64_t before = statistics_.telemetry;
  do {
    KAZ_TRY(pump(deadline));
  } while (statistics_.telemetry == before && clock_.now() < deadline);
  return statistics_.telemetry != before;
}

Result<void> Requester::send(const Request& request) {
  Waiting waiting;
  waiting.request = request;
  ++statistics_.requests;
  std::vector<std::uint8_t> wire;
  append(waiting, wire);
  return write(wire);
}

void Requester::start_anew() {
  queue_.clear();
  noise_.clear();
  round_trip_.start_anew();
  kz_receiver_init(&receiver_);
  next_sequence_ = static_cast<std::uint8_t>(next_sequence_ + kSequenceLeap);
  wire_free_ = clock_.now();
}

const LinkStatistics& Requester::statistics() const {
  statistics_.round_trip = round_trip_.statistics();
  return statistics_;
}

Requester::Ticket Requester::enqueue(const Request& request, bool at_once) {
  Waiting waiting;
  waiting.ticket = next_ticket_++;
  waiting.request = request;
  waiting.at_once = at_once;
  ++statistics_.requests;
  const Ticket ticket = waiting.ticket;
  if (at_once) {
    queue_.push_front(std::move(waiting));
  } else {
    queue_.push_back(std::move(waiting));
  }
  return ticket;
}

Result<void> Requester::send_waiting() {
  std::vector<std::uint8_t> wire;
  int under_way = 0;
  bool command_under_way = false;
  for (Waiting& w : queue_) {
    if (w.done) continue;
    const bool command = !kz_is_query(w.request.type);
    if (w.tries == 0) {
      const bool room = under_way < KZ_REQUESTS_UNDER_WAY && !(command && command_under_way);
      if (!w.at_once && !room) break;
      append(w, wire);
    }
    ++under_way;
    command_under_way = command_under_way || command;
  }
  return wire.empty() ? Result<void>() : write(wire);
}

Result<void> Requester::pump(Time deadline) {
  for (const Waiting& w : queue_) {
    if (w.under_way()) deadline = std::min(deadline, w.deadline);
  }
  std::array<std::uint8_t, 256> buffer;
  const auto count = link_.read(buffer, deadline);
  if (!count) {
    timed_out_ = false;
    return give_up(count.error());
  }
  take({buffer.data(), *count}, clock_.now());
  if (auto repeated = repeat_overdue(); !repeated) return give_up(repeated.error());
  if (auto sent = send_waiting(); !sent) return give_up(sent.error());
  return {};
}

Result<void> Requester::give_up(Error error) {
  queue_.clear();
  return tl::unexpected(std::move(error));
}

// Boards of protocol version 2 answer a request from memory whose number and contents are those of an earlier
// one, and do not execute it. After start_anew() the next numbers may be those of requests just before.
std::uint8_t Requester::fresh_sequence() {
  while (std::ranges::find(recent_sequences_, next_sequence_) != recent_sequences_.end())
    ++next_sequence_;
  recent_sequences_.push_back(next_sequence_);
  if (recent_sequences_.size() > kSequencesApart) recent_sequences_.pop_front();
  return next_sequence_++;
}

// `wire` may hold earlier requests of the same batch.
void Requester::append(Waiting& waiting, std::vector<std::uint8_t>& wire) {
  const Fields& fields = waiting.request.fields;
  std::array<std::uint8_t, KZ_BODY_MAX> body;
  body[0] = options_.address;
  body[1] = waiting.request.type;
  std::copy_n(fields.bytes.begin(), fields.length, body.begin() + KZ_HEADER_SIZE);
  const auto body_length = static_cast<std::uint8_t>(KZ_HEADER_SIZE + fields.length);

  // A repetition keeps its number, unless it only switches off: then a board that remembers it must execute
  // it again. One that was busy does not remember it.
  const bool fresh = waiting.tries == 0 || (!waiting.busy && only_switches_off(waiting.request));
  if (fresh) waiting.sequences.push_back(fresh_sequence());
  std::array<std::uint8_t, KZ_FRAME_MAX> frame;
  const auto encode = [&] {
    body[2] = waiting.sequences.back();
    return kz_frame_encode(body.data(), body_length, frame.data());
  };
  std::uint8_t length = encode();
  // Takes another number where one damaged byte could leave a valid frame (frame.h).
  for (int i = 0; i < 8 && fresh && kz_frame_splits(frame.data(), length); ++i) {
    waiting.sequences.back() = fresh_sequence();
    length = encode();
  }
  wire.insert(wire.end(), frame.begin(), frame.begin() + length);

  const Time now = clock_.now();
  if (++waiting.tries == 1) {
    waiting.first = now;
  } else {
    ++statistics_.retries;
  }
  waiting.transmission = ++transmissions_;
  waiting.busy = waiting.lost = false;
  waiting.sent = std::max(now, wire_free_);
  wire_free_ = waiting.sent + length * byte_time_;
  waiting.deadline = waiting.sent + (kz_writes_flash(waiting.request.type) ? options_.flash_timeout
                                                                           : round_trip_.timeout());
  waiting.bytes_out = length;
  last_sent_ = now;
  frames_.add(now, FrameLog::Direction::out, {body.data(), body_length});
}

Result<void> Requester::write(std::span<const std::uint8_t> wire) {
  statistics_.bytes_out += wire.size();
  auto written = link_.write(wire);
  if (written) return {};
  timed_out_ = false;
  return give_up(written.error());
}

Result<void> Requester::repeat_overdue() {
  const Time now = clock_.now();
  bool first = true;
  for (Waiting& w : queue_) {
    if (!w.under_way()) continue;
    if (now >= w.deadline) {
      if (!w.busy) ++w.unanswered;
      if (!w.busy && !w.lost) {
        ++statistics_.timeouts;
        if (first && !kz_writes_flash(w.request.type)) round_trip_.back_off();
      }
      if (auto repeated = repeat(w); !repeated) return repeated;
    }
    first = false;
  }
  return {};
}

Result<void> Requester::repeat(Waiting& waiting) {
  const std::string request = std::string("`") + message_name(waiting.request.type) + "`";
  if (waiting.busy && clock_.now() - waiting.first > kBusyPatience) {
    return fail(Fault::environment, "the board on " + link_.name() + " remains busy: it refused " +
                                        request + " again and again");
  }
  if (waiting.unanswered >= tries()) {
    timed_out_ = true;
    char time[32];
    std::snprintf(time, sizeof time, "%.1f s", seconds(clock_.now() - waiting.first));
    return fail(Fault::environment, "the board on " + link_.name() +
                                        " stopped answering: no reply to " + request + " in " +
                                        std::to_string(waiting.unanswered) + " tries and " + time +
                                        "; check its power and the cable");
  }
  std::vector<std::uint8_t> wire;
  append(waiting, wire);
  return write(wire);
}

void Requester::take(std::span<const std::uint8_t> bytes, Time now) {
  statistics_.bytes_in += bytes.size();
  for (const std::uint8_t byte : bytes) {
    if (noise_.size() < kNoiseKept) noise_.push_back(byte);
    const std::uint8_t event = kz_receive(&receiver_, byte, 0);
    if (event == KZ_RECEIVE_MORE) continue;
    if (event == KZ_RECEIVE_FRAME) {
      noise_.clear();
      take_frame(now);
    } else {
      ++statistics_.bad_frames;
      frames_.add(now, FrameLog::Direction::damaged, {receiver_.body, receiver_.length});
    }
  }
}

void Requester::take_frame(Time now) {
  const std::span<const std::uint8_t> body(receiver_.body, receiver_.length);
  frames_.add(now, FrameLog::Direction::in, body);
  const std::uint8_t type = body[1];
  if (body[0] != options_.address) {
    ++statistics_.ignored;
    return;
  }
  if (!(type & KZ_REPLY)) heard_echo_ = true;
  const auto fields = body.subspan(KZ_HEADER_SIZE);
  if (type >= KZ_TYPE_telemetry_state && type <= KZ_TYPE_telemetry_health) {
    ++statistics_.telemetry;
    if (telemetry_) telemetry_(type, fields, now);
    return;
  }

  kz_refused refusal{};
  const bool refused =
      type == KZ_TYPE_refused &&
      kz_unpack_refused(&refusal, fields.data(), static_cast<std::uint8_t>(fields.size()));
  const auto waiting = std::find_if(queue_.begin(), queue_.end(), [&](const Waiting& w) {
    const bool fits =
        refused ? refusal.request == w.request.type : type == reply_type(w.request.type);
    return w.under_way() && fits && std::ranges::find(w.sequences, body[2]) != w.sequences.end();
  });
  if (waiting == queue_.end()) {
    ++statistics_.ignored;
  } else if (refused && refusal.reason == KZ_REFUSED_BUSY) {
    // Not executed, and not remembered: the same number again, which makes it a repetition if an earlier
    // transmission was executed.
    ++statistics_.busy;
    waiting->busy = true;
    waiting->deadline = now + kBusyPause;
  } else {
    repeat_what_was_lost(*waiting, now);
    if (kz_is_query(waiting->request.type) && answered_too_early(*waiting, now)) return;
    // A board of protocol version 2 may have taken it for a repetition of another program's: once more.
    if (!refused && waiting->sequences.size() == 1 && waiting->tries < tries() &&
        motors_stay_on(waiting->request, fields)) {
      waiting->lost = true;
      waiting->deadline = now;
      return;
    }
    finish(*waiting, fields, refused, now);
  }
}

void Requester::finish(Waiting& waiting, std::span<const std::uint8_t> fields, bool refused,
                       Time now) {
  waiting.done = true;
  Reply& reply = waiting.reply;
  reply.refused = refused;
  std::copy(fields.begin(), fields.end(), reply.fields.bytes.begin());
  reply.fields.length = static_cast<std::uint8_t>(fields.size());
  reply.timed = waiting.tries == 1;
  reply.sent = waiting.sent;
  reply.received = now;
  reply.bytes_out = waiting.bytes_out;
  reply.bytes_in = static_cast<int>(KZ_HEADER_SIZE + fields.size()) + kFrameOverhead;
  ++(refused ? statistics_.refused : statistics_.replies);
  if (reply.timed && !kz_writes_flash(waiting.request.type)) {
    round_trip_.add(reply.received - reply.sent);
  }
}

// True if an earlier command is still without reply: it may have been lost, so that the reply to this query
// may predate its effect. The query is then repeated after the command.
bool Requester::answered_too_early(Waiting& query, Time now) {
  for (const Waiting& w : queue_) {
    if (!w.under_way() || w.ticket >= query.ticket || kz_is_query(w.request.type)) continue;
    ++statistics_.ignored;
    query.lost = true;
    query.deadline = std::max(now, w.deadline);
    return true;
  }
  return false;
}

// The board answers in order: what was sent before `answered` and is not answered, it did not get,
// or its reply was lost. Both only if neither was sent twice, for then the order is not known.
void Requester::repeat_what_was_lost(const Waiting& answered, Time now) {
  if (answered.tries != 1) return;
  for (Waiting& w : queue_) {
    if (w.under_way() && !w.busy && w.tries == 1 && w.transmission < answered.transmission) {
      w.lost = true;
      w.deadline = now;
    }
  }
}

}  // namespace kaz::host
