// The board under test, as the cases talk to it.
// SPDX-License-Identifier: Apache-2.0
#include "hil/conformance/board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "host/robot/find_boards.h"
#include "shared/base/hex_text.hpp"

namespace kaz::hil {
namespace {

using std::chrono::milliseconds;

constexpr int kReplyMs = 30;  // the longest reply behind the longest other one, and some
constexpr int kStartMs = 200;
constexpr std::size_t kTranscriptLines = 60;

template <class T>
T or_lost(Result<T> result) {
  if (!result) throw Lost{result.error()};
  return *std::move(result);
}
void or_lost(Result<void> result) {
  if (!result) throw Lost{result.error()};
}

std::string type_text(std::uint8_t type) {
  for (const Message& one : messages()) {
    if (one.code == type) return one.name;
  }
  return std::string("type ").append(std::to_string(type));
}

}  // namespace

bool is_telemetry(const Frame& frame) {
  return frame.type >= 0xC0 && frame.type < 0xFF;
}

Board::Board(host::Link& link, host::Clock& clock, Bench* bench, Time slack, std::uint64_t seed,
             std::uint8_t home)
    : address(home),
      link_(link),
      clock_(clock),
      bench_(bench),
      slack_(slack),
      seed_(seed),
      home_(home) {}

void Board::note(char direction, const Bytes& bytes) {
  if (direction == last_direction_ && !transcript_.empty()) {
    transcript_.back().append(1, ' ').append(hex_text(bytes, " "));
    return;
  }
  if (transcript_.size() == kTranscriptLines) transcript_.erase(transcript_.begin());
  char head[32];
  const double ms = std::chrono::duration<double, std::milli>(clock_.now() - started_).count();
  std::snprintf(head, sizeof head, "%9.1f ms %c ", ms, direction);
  transcript_.push_back(head + hex_text(bytes, " "));
  last_direction_ = direction;
}

void Board::pump(Time deadline) {
  std::array<std::uint8_t, 256> buffer;
  const std::size_t count = or_lost(link_.read(buffer, deadline));
  if (count == 0) return;
  note('<', {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(count)});
  for (std::size_t i = 0; i < count; ++i) {
    if (auto frame = deframer_.take(buffer[i], clock_.now())) frames_.push_back(*frame);
  }
}

void Board::begin(std::uint64_t case_seed) {
  random_.seed(seed_ * 0x9E3779B97F4A7C15u + case_seed);
  sequence_ = static_cast<std::uint8_t>(random_());
  address = home_;
  transcript_.clear();
  last_direction_ = 0;
  started_ = clock_.now();
  if (bench_ != nullptr) {
    bench_->restore();
    bench_->reset();
    come_back(kStartMs);
    return;
  }
  come_back(kStartMs);  // it may still be starting from the case before
  done("telemetry", Put().u16(0).u8(0));
  done("enable", Put().u32(0));
  reset_by_command();
  if (std::exchange(moved_, false)) come_to_rest();
}

// Joints that a case before has set moving swing on for a while.
void Board::come_to_rest() {
  constexpr int kStill = 25, kAtMostMs = 3000;  // 100 urad: the flicker of one code is 32
  const auto angles = [this] {
    const Reply now = state();
    std::array<int, KZ_JOINTS> all{};
    for (std::size_t j = 0; j < KZ_JOINTS; ++j)
      all[j] = static_cast<int>(now.number("angle", static_cast<int>(j)));
    return all;
  };
  auto before = angles();
  int still_ms = 0;
  for (int ms = 0; ms < kAtMostMs && still_ms < 100; ms += 20) {
    wait(20);
    const auto now = angles();
    int max_change = 0;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j)
      max_change = std::max(max_change, std::abs(now[j] - before[j]));
    still_ms = max_change <= 2 * kStill ? still_ms + 20 : 0;
    if (still_ms == 0) before = now;
  }
}

void Board::end() {
  write(request_bytes("telemetry", Put().u16(0).u8(0)));
  wait(5);
  write(request_bytes("enable", Put().u32(0)));
  wait(10);
}

void Board::come_back(int at_most_ms) {
  const Time last = clock_.now() + milliseconds(at_most_ms) + 4 * slack_;
  while (true) {
    deframer_.forget();
    frames_.clear();
    const std::uint8_t sequence = new_sequence();
    write(request_bytes("identify", {}, sequence));
    const Time deadline = clock_.now() + milliseconds(20) + slack_;
    while (clock_.now() < deadline) {
      pump(deadline);
      for (const Frame& frame : frames_) {
        if (frame.type != (KZ_TYPE_identify | KZ_REPLY) || frame.sequence != sequence) continue;
        frames_.clear();
        deframer_.forget();
        return;
      }
    }
    check(clock_.now() < last,
          "the board does not reply within " + std::to_string(at_most_ms) + " ms of a reset");
  }
}

void Board::write(const Bytes& bytes) {
  note('>', bytes);
  or_lost(link_.write(bytes));
}

int Board::patience(int ms) const {
  return (ms == 0 ? kReplyMs : ms) +
         static_cast<int>(std::chrono::duration_cast<milliseconds>(slack_).count()) * 4;
}

std::optional<Frame> Board::next(int at_most_ms) {
  const Time deadline = clock_.now() + milliseconds(at_most_ms);
  while (frames_.empty() && clock_.now() < deadline) pump(deadline);
  if (frames_.empty()) return std::nullopt;
  Frame frame = frames_.front();
  frames_.pop_front();
  return frame;
}

void Board::wait(int ms) {
  const Time deadline = clock_.now() + milliseconds(ms);
  while (clock_.now() < deadline) pump(deadline);
}

void Board::silence(int ms) {
  wait(ms + static_cast<int>(std::chrono::duration_cast<milliseconds>(slack_).count()));
  for (const Frame& frame : frames_) {
    check(is_telemetry(frame), "unexpected frame: " + type_text(frame.type));
  }
}

Bytes Board::request_bytes(std::string_view name, const Bytes& fields) {
  return request_bytes(name, fields, new_sequence());
}

Bytes Board::request_bytes(std::string_view name, const Bytes& fields,
                           std::uint8_t sequence) const {
  if ((name == "enable" || name == "raw_drive") &&
      std::any_of(fields.begin(), fields.end(), [](std::uint8_t byte) { return byte != 0; })) {
    moved_ = true;
  }
  return frame_of(address, message(name).code, sequence, fields);
}

Frame Board::expect_frame(std::uint8_t type, std::uint8_t sequence, int at_most_ms) {
  const Time deadline = clock_.now() + milliseconds(patience(at_most_ms));
  while (true) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - clock_.now()).count();
    const auto frame = next(static_cast<int>(std::max<long>(left, 0)));
    check(frame.has_value(), "no reply: expected " + type_text(type));
    if (is_telemetry(*frame)) continue;
    check(frame->type == type, "expected " + type_text(type) + ", got " + type_text(frame->type) +
                                   ": " + hex_text(frame->fields, " "));
    equal(type_text(type) + ": sequence number", frame->sequence, sequence);
    equal(type_text(type) + ": address", frame->address, address);
    return *frame;
  }
}

Frame Board::raw_request(std::uint8_t type, const Bytes& fields) {
  const std::uint8_t sequence = new_sequence();
  write(frame_of(address, type, sequence, fields));
  const Time deadline = clock_.now() + milliseconds(patience(0));
  while (true) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - clock_.now()).count();
    const auto frame = next(static_cast<int>(std::max<long>(left, 0)));
    check(frame.has_value(), "no reply to " + type_text(type));
    if (is_telemetry(*frame)) continue;
    equal("sequence number of the reply to " + type_text(type), frame->sequence, sequence);
    return *frame;
  }
}

bool Board::answers() {
  write(request_bytes("identify"));
  const bool answered = next(patience(50)).has_value();
  frames_.clear();
  return answered;
}

bool Board::gone() {
  if (bench_ != nullptr) return false;
  constexpr int kRounds = 4;  // 2 s
  return or_lost(host::find_boards(link_, clock_, {.rounds = kRounds})).empty();
}

Reply Board::take(std::string_view name, std::uint8_t sequence, int at_most_ms) {
  const Message& reply = message(std::string(name) + "_reply");
  return {reply, expect_frame(reply.code, sequence, at_most_ms)};
}

Reply Board::done(std::string_view name, const Bytes& fields, int at_most_ms) {
  const std::uint8_t sequence = new_sequence();
  write(request_bytes(name, fields, sequence));
  return take(name, sequence, at_most_ms);
}

Reply Board::take_refusal(std::uint8_t type, std::uint8_t sequence, int reason, int detail) {
  const Reply reply(message("refused"), expect_frame(KZ_TYPE_refused, sequence));
  equal("refused: request type", reply["request"], type);
  equal("refusal reason for " + type_text(type), reply["reason"], reason);
  if (detail != kAnyDetail) {
    equal("refusal detail for " + type_text(type), reply["detail"], detail);
  }
  return reply;
}

Reply Board::refused_type(std::uint8_t type, const Bytes& fields, int reason, int detail) {
  const std::uint8_t sequence = new_sequence();
  write(frame_of(address, type, sequence, fields));
  return take_refusal(type, sequence, reason, detail);
}

Reply Board::refused(std::string_view name, const Bytes& fields, int reason, int detail) {
  return refused_type(message(name).code, fields, reason, detail);
}

void Board::enable(unsigned mask) {
  const Reply reply = done("enable", Put().u32(mask));
  equal("enable: joints that are on", reply["mask"], static_cast<long>(mask));
}

void Board::target(int joint, long angle, int duration_ms) {
  done("targets", Put().u32(1L << joint).u16(duration_ms).s16(angle));
}

void Board::watchdog(int ten_ms, int reaction) {
  done("heartbeat", Put().u8(ten_ms).u8(reaction));
}

void Board::stay_alive(int ms) {
  const Time until = clock_.now() + milliseconds(ms);
  while (clock_.now() < until) {
    watchdog(0);
    const auto left = std::chrono::ceil<milliseconds>(until - clock_.now()).count();
    if (left > 0) wait(static_cast<int>(std::min<long>(left, 30)));
  }
}

void Board::wait_until_still() {
  for (int n = 0; n < 100; ++n) {
    if (!state().flag(KZ_STATUS_MOVING)) return;
    wait(20);
  }
  throw Failed{"MOVING is still set after 2 s"};
}

void Board::reset_by_command() {
  done("reset", Put().u16(KZ_KEY));
  wait(10);
  come_back(kStartMs);
}

void Board::expect_alive() {
  done("identify");
}

void Board::expect_off() {
  const Reply now = state();
  check(!now.flag(KZ_STATUS_ENABLED), "the status reports that a motor is on");
  if (bench_ == nullptr) return;
  for (int joint = 0; joint < KZ_JOINTS; ++joint) {
    check(bench_->drive(joint) == 0, "the motor of joint " + std::to_string(joint) + " has power");
  }
}

std::vector<Frame> Board::telemetry(int ms, bool heartbeats) {
  std::vector<Frame> all;
  const Time until = clock_.now() + milliseconds(ms);
  Time next_heartbeat = clock_.now();
  std::ptrdiff_t sent_heartbeats = 0;
  while (clock_.now() < until) {
    if (heartbeats && clock_.now() >= next_heartbeat) {
      write(request_bytes("heartbeat", Put().u8(0).u8(0)));
      ++sent_heartbeats;
      next_heartbeat += milliseconds(30);
    }
    pump(std::min(until, heartbeats ? next_heartbeat : until));
  }
  // The last heartbeat's reply may still be under way: it must not be taken for a later request's.
  const u8 reply = static_cast<u8>(KZ_TYPE_heartbeat | KZ_REPLY);
  const auto unanswered = [&] {
    return sent_heartbeats > std::count_if(frames_.begin(), frames_.end(),
                                           [&](const Frame& frame) { return frame.type == reply; });
  };
  const Time latest = clock_.now() + milliseconds(patience(50));
  while (unanswered() && clock_.now() < latest) pump(latest);
  for (const Frame& frame : frames_) {
    if (is_telemetry(frame)) all.push_back(frame);
  }
  frames_.clear();
  return all;
}

}  // namespace kaz::hil
