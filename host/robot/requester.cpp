// Writes frames, collects replies, repeats what was not answered.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/requester.h"

#include <algorithm>

#include "shared/protocol/messages.h"

namespace kaz::host {

namespace {

constexpr std::size_t kNoiseKept = 64;
constexpr Time kBusyPause = std::chrono::milliseconds(2);
constexpr int kFrameOverhead = KZ_FRAME_MAX - KZ_BODY_MAX;

constexpr std::uint8_t reply_type(std::uint8_t request) {
  return request | KZ_REPLY;
}

}  // namespace

struct Requester::Waiting {
  const Request* request = nullptr;
  std::uint8_t sequence = 0;
  int tries = 0;
  bool done = false, busy = false;
  Time sent{}, deadline{};
  int bytes_out = 0;
  Reply reply;
};

Requester::Requester(Link& link, Clock& clock, const RequesterOptions& options)
    : link_(link),
      clock_(clock),
      options_(options),
      // Differs from one program run to the next, so that a board does not take a new request for
      // the repetition of an old one; in simulated time it is the same in each run.
      next_sequence_(static_cast<std::uint8_t>(clock.now().count() >> 10)) {
  kz_receiver_init(&receiver_);
}

Result<std::vector<Reply>> Requester::ask(std::span<const Request> requests) {
  timed_out_ = false;
  const Time started = clock_.now();
  std::vector<Waiting> all(requests.size());
  std::vector<std::uint8_t> wire;
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].request = &requests[i];
    all[i].sequence = next_sequence_++;
    ++statistics_.requests;
    append(all[i], wire);
  }
  if (auto written = write(wire); !written) return tl::unexpected(written.error());

  const auto done = [](const Waiting& w) { return w.done; };
  while (!std::all_of(all.begin(), all.end(), done)) {
    Time deadline = Time::max();
    for (const Waiting& w : all) {
      if (!w.done) deadline = std::min(deadline, w.deadline);
    }
    std::array<std::uint8_t, 256> buffer;
    const auto count = link_.read(buffer, deadline);
    if (!count) return tl::unexpected(count.error());
    take({buffer.data(), *count}, clock_.now(), all);
    if (auto repeated = repeat_overdue(all, started); !repeated) {
      return tl::unexpected(repeated.error());
    }
  }

  std::vector<Reply> replies;
  for (Waiting& w : all) replies.push_back(std::move(w.reply));
  return replies;
}

Result<void> Requester::tell(const Request& request) {
  Waiting waiting;
  waiting.request = &request;
  waiting.sequence = next_sequence_++;
  ++statistics_.requests;
  std::vector<std::uint8_t> wire;
  append(waiting, wire);
  return write(wire);
}

// Bytes that pass in a little more than one tick.
std::size_t Requester::bytes_per_tick() const {
  constexpr Time kTick = std::chrono::nanoseconds(1'000'000'000 / KZ_TICK_HZ);
  constexpr Time kUsual = std::chrono::nanoseconds(10'000'000'000 / KZ_BAUD);
  const Time byte_time = link_.byte_time() > Time::zero() ? link_.byte_time() : kUsual;
  return static_cast<std::size_t>(kTick / byte_time) + 1;
}

// `wire` may hold earlier requests of the same batch: their bytes pass before the board has this
// one.
void Requester::append(Waiting& waiting, std::vector<std::uint8_t>& wire) {
  const Fields& fields = waiting.request->fields;
  std::array<std::uint8_t, KZ_BODY_MAX> body;
  body[0] = options_.address;
  body[1] = waiting.request->type;
  body[2] = waiting.sequence;
  std::copy_n(fields.bytes.begin(), fields.length, body.begin() + KZ_HEADER_SIZE);
  const auto body_length = static_cast<std::uint8_t>(KZ_HEADER_SIZE + fields.length);

  std::array<std::uint8_t, KZ_FRAME_MAX> frame;
  const std::uint8_t length = kz_frame_encode(body.data(), body_length, frame.data());
  // Zeros between frames mean nothing.
  if (!wire.empty() && length < bytes_per_tick())
    wire.resize(wire.size() + bytes_per_tick() - length);
  wire.insert(wire.end(), frame.begin(), frame.begin() + length);

  ++waiting.tries;
  waiting.sent = clock_.now();
  waiting.deadline = waiting.sent + options_.timeout;
  waiting.bytes_out = static_cast<int>(wire.size());
  frames_.add(waiting.sent, FrameLog::Direction::out, {body.data(), body_length});
}

Result<void> Requester::write(std::span<const std::uint8_t> wire) {
  statistics_.bytes_out += wire.size();
  return link_.write(wire);
}

Result<void> Requester::repeat_overdue(std::span<Waiting> all, Time started) {
  const Time now = clock_.now();
  for (Waiting& w : all) {
    if (w.done || now < w.deadline) continue;
    if (w.busy) {
      if (now - started > options_.timeout * (options_.retries + 1)) {
        return fail(Fault::environment, "the board on " + link_.name() + " is always busy: `" +
                                            message_name(w.request->type) +
                                            "` was refused again and again");
      }
      w.busy = false;
      w.tries = 0;
      w.sequence = next_sequence_++;
    } else {
      ++statistics_.timeouts;
      if (w.tries > options_.retries) {
        timed_out_ = true;
        return fail(Fault::environment,
                    "the board on " + link_.name() + " stopped answering: no reply to `" +
                        message_name(w.request->type) + "` in " + std::to_string(w.tries) +
                        " tries of " + std::to_string(options_.timeout.count() / 1'000'000) +
                        " ms; check its power and the cable");
      }
      ++statistics_.retries;
    }
    std::vector<std::uint8_t> wire;
    append(w, wire);
    if (auto written = write(wire); !written) return written;
  }
  return {};
}

void Requester::take(std::span<const std::uint8_t> bytes, Time now, std::span<Waiting> all) {
  statistics_.bytes_in += bytes.size();
  for (const std::uint8_t byte : bytes) {
    if (noise_.size() < kNoiseKept) noise_.push_back(byte);
    const std::uint8_t event = kz_receive(&receiver_, byte, 0);
    if (event == KZ_RECEIVE_MORE) continue;
    if (event == KZ_RECEIVE_FRAME) {
      noise_.clear();
      take_frame(now, all);
    } else {
      ++statistics_.bad_frames;
      frames_.add(now, FrameLog::Direction::damaged, {receiver_.body, receiver_.length});
    }
  }
}

void Requester::take_frame(Time now, std::span<Waiting> all) {
  const std::span<const std::uint8_t> body(receiver_.body, receiver_.length);
  frames_.add(now, FrameLog::Direction::in, body);
  if (body[0] == options_.address && !(body[1] & KZ_REPLY)) heard_echo_ = true;

  const auto fields = body.subspan(KZ_HEADER_SIZE);
  kz_refused refusal{};
  const bool refused =
      body[1] == KZ_TYPE_refused &&
      kz_unpack_refused(&refusal, fields.data(), static_cast<std::uint8_t>(fields.size()));
  const auto waiting = std::find_if(all.begin(), all.end(), [&](const Waiting& w) {
    const bool fits =
        refused ? refusal.request == w.request->type : body[1] == reply_type(w.request->type);
    return !w.done && !w.busy && body[0] == options_.address && body[2] == w.sequence && fits;
  });
  if (waiting == all.end()) {
    ++statistics_.ignored;
    return;
  }
  if (refused && refusal.reason == KZ_REFUSED_BUSY) {
    waiting->busy = true;
    waiting->deadline = now + kBusyPause;
    return;
  }

  waiting->done = true;
  Reply& reply = waiting->reply;
  reply.refused = refused;
  std::copy(fields.begin(), fields.end(), reply.fields.bytes.begin());
  reply.fields.length = static_cast<std::uint8_t>(fields.size());
  reply.timed = waiting->tries == 1;
  reply.sent = waiting->sent;
  reply.received = now;
  reply.bytes_out = waiting->bytes_out;
  reply.bytes_in = static_cast<int>(body.size()) + kFrameOverhead;
  ++(refused ? statistics_.refused : statistics_.replies);
  if (reply.timed) {
    const double round_trip = seconds(reply.received - reply.sent);
    double& smoothed = statistics_.round_trip_s;
    smoothed = smoothed == 0 ? round_trip : smoothed + (round_trip - smoothed) / 8;
  }
}

}  // namespace kaz::host
