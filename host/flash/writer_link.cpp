// Frames to and from the flash writer.
// SPDX-License-Identifier: Apache-2.0
#include "host/flash/writer_link.h"

#include <algorithm>
#include <array>
#include <utility>

#include "host/flash/diagnostic.h"
#include "shared/protocol/crc16.h"

namespace kaz::host {
namespace {

using std::chrono::milliseconds;

// Longer than the writer's time-out within a frame.
constexpr Time kQuiet = milliseconds(30);

std::uint16_t crc_of(std::span<const std::uint8_t> bytes) {
  std::uint16_t crc = 0xffff;
  for (const std::uint8_t byte : bytes) crc = kz_crc16_step(crc, byte);
  return crc;
}

}  // namespace

void WriterLink::begin_try() {
  if (lateness_) lateness_->begin();
}

bool WriterLink::excused(int& left) const {
  if (!lateness_ || left == 0 || lateness_->excuse().empty() || lateness_->other_end_gone())
    return false;
  --left;
  return true;
}

tl::unexpected<Error> WriterLink::no_answer(int tries) const {
  std::vector<std::string> causes{
      "the board lost power or was reset during the transfer",
      "the line is disturbed: check cable, ground, and other programs on the port",
      "the adapter does not keep up with 115200 baud"};
  const std::string excuse = lateness_ ? lateness_->excuse() : "";
  if (!excuse.empty()) causes.insert(causes.begin(), "this machine is too busy: " + excuse);
  return fail(
      Fault::environment,
      Diagnostic{"the flash writer in the board's RAM stopped answering",
                 "a reply to a request that was sent " + std::to_string(tries) + " times",
                 "no valid reply on " + link_.name(), causes,
                 "give the same command again; the board can always be flashed in boot mode"});
}

void append(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes) {
  for (int k = bytes - 1; k >= 0; --k) to.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

std::string status_text(int status) {
  switch (status) {
    case KZ_WRITER_OK:
      return "done";
    case KZ_WRITER_DAMAGED:
      return "a received frame was damaged";
    case KZ_WRITER_UNKNOWN:
      return "it does not support the request";
    case KZ_WRITER_ARGUMENTS:
      return "address or length is out of range";
    case KZ_WRITER_PROTECTED:
      return "it protects the blocks of vectors and loader, and its own program in RAM";
    case KZ_WRITER_NOT_ERASED:
      return "flash cells are not erased after the maximum number of erase pulses";
    case KZ_WRITER_NOT_WRITTEN:
      return "flash cells do not have the written value after the maximum number of program pulses";
    case KZ_WRITER_NOT_BLANK:
      return "the cells hold other data: erase them first";
    case KZ_WRITER_LOCKED:
      return "the chip's error protection is on until reset";
    case KZ_WRITER_NOTHING:
      return "the reset vector is blank";
    default:
      return "status " + std::to_string(status);
  }
}

void WriterSums::add(std::uint8_t byte) {
  crc = kz_crc16_step(crc, byte);
  plain = static_cast<std::uint16_t>(plain + byte);
  sums = static_cast<std::uint16_t>(sums + plain);
}

Result<void> WriterLink::send(const WriterRequest& request, std::uint8_t number) {
  std::vector<std::uint8_t> frame{KZ_WRITER_SYNC, request.type};
  append(frame, static_cast<std::uint32_t>(request.payload.size()), 2);
  frame.push_back(number);
  unsigned sum = 0;
  for (std::size_t k = 1; k < frame.size(); ++k) sum += frame[k];
  frame.push_back(static_cast<std::uint8_t>(~sum));
  frame.insert(frame.end(), request.payload.begin(), request.payload.end());
  append(frame, crc_of(std::span(frame).subspan(1)), 2);
  return link_.write(frame);
}

// Takes a frame from the front of the received bytes; bytes that are no frame are discarded.
bool WriterLink::parse(WriterReply& reply) {
  while (!buffer_.empty()) {
    const auto start = std::find(buffer_.begin(), buffer_.end(), KZ_WRITER_SYNC);
    buffer_.erase(buffer_.begin(), start);
    if (buffer_.size() < KZ_WRITER_HEADER) return false;
    unsigned sum = 0;
    for (std::size_t k = 1; k < 6; ++k) sum += buffer_[k];
    const std::size_t length = static_cast<std::size_t>(buffer_[2]) << 8 | buffer_[3];
    if ((sum & 0xff) != 0xff || length < 2 || length > KZ_WRITER_PAYLOAD_MAX ||
        !(buffer_[1] & KZ_WRITER_REPLY)) {
      buffer_.erase(buffer_.begin());
      continue;
    }
    const std::size_t whole = length + KZ_WRITER_OVERHEAD;
    if (buffer_.size() < whole) return false;
    if (crc_of(std::span(buffer_).subspan(1, whole - 1)) != 0) {
      buffer_.erase(buffer_.begin());
      continue;
    }
    reply.type = static_cast<std::uint8_t>(buffer_[1] & ~KZ_WRITER_REPLY);
    reply.number = buffer_[4];
    reply.status = buffer_[KZ_WRITER_HEADER];
    reply.data.assign(buffer_.begin() + KZ_WRITER_HEADER + 2,
                      buffer_.begin() + static_cast<std::ptrdiff_t>(whole) - 2);
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(whole));
    return true;
  }
  return false;
}

Result<std::optional<WriterReply>> WriterLink::receive(Time deadline) {
  WriterReply reply;
  while (!parse(reply)) {
    std::array<std::uint8_t, 1024> bytes{};
    const auto count = KAZ_TRY(link_.read(bytes, deadline));
    if (count == 0) return std::optional<WriterReply>();
    buffer_.insert(buffer_.end(), bytes.begin(),
                   bytes.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return std::optional(std::move(reply));
}

Result<void> WriterLink::settle() {
  std::array<std::uint8_t, 1024> bytes{};
  // If the line never becomes quiet, sends anyway.
  const Time end = clock_.now() + milliseconds(300);
  while (clock_.now() < end) {
    const auto count = KAZ_TRY(link_.read(bytes, clock_.now() + kQuiet));
    if (count == 0) break;
    buffer_.insert(buffer_.end(), bytes.begin(),
                   bytes.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return {};
}

Result<WriterReply> WriterLink::exchange(const WriterRequest& request, Time patience, int tries) {
  const std::uint8_t number = ++number_;
  silent_ = false;
  const auto is_mine = [&](const WriterReply& reply) {
    return reply.number == number && reply.type == request.type &&
           reply.status != KZ_WRITER_DAMAGED;
  };
  int excuses = LatenessMeter::kRepetitions;
  bool repeats = false;
  for (int k = 0; k < tries; k += excused(excuses) ? 0 : 1) {
    if (std::exchange(repeats, true)) {
      KAZ_TRY(settle());
      WriterReply late;
      while (parse(late)) {
        if (is_mine(late)) return late;
      }
      buffer_.clear();
      ++repeated_;
    }
    begin_try();
    KAZ_TRY(send(request, number));
    const Time deadline = clock_.now() + patience * (k < 3 ? 1 : 2);
    while (true) {
      auto reply = KAZ_TRY(receive(deadline));
      if (!reply || reply->status == KZ_WRITER_DAMAGED) break;  // again
      if (is_mine(*reply)) return std::move(*reply);
    }
  }
  silent_ = true;
  return no_answer(tries);
}

Result<void> WriterLink::exchange_all(
    const std::function<std::optional<WriterRequest>()>& next, Time patience,
    const std::function<Result<void>(const WriterRequest&, const WriterReply&)>& answered) {
  struct UnderWay {
    WriterRequest request;
    std::uint8_t number;
    int tries;
  };
  constexpr int kTries = 8;
  std::deque<UnderWay> under_way;
  int excuses = LatenessMeter::kRepetitions;
  bool more = true;
  begin_try();
  // The time-out adapts, so that a slow board or adapter (an emulated one on a busy machine) does not
  // cause repetition after repetition.
  const auto patient = [&] { return std::clamp(2 * took_, patience, 4 * patience); };
  Time since = clock_.now(), deadline = since + patient();
  const auto answers_first = [&](const WriterReply& reply) {
    return !under_way.empty() && reply.number == under_way.front().number &&
           reply.type == under_way.front().request.type;
  };
  const auto take = [&](const WriterReply& reply) -> Result<void> {
    if (auto taken = answered(under_way.front().request, reply); !taken) return taken;
    under_way.pop_front();
    took_ = std::max(clock_.now() - since, took_ * 3 / 4);
    since = clock_.now();
    deadline = since + patient();
    return {};
  };
  while (true) {
    while (more && under_way.size() < KZ_WRITER_WINDOW) {
      auto request = next();
      more = request.has_value();
      if (!more) break;
      under_way.push_back({std::move(*request), ++number_, 1});
      if (auto sent = send(under_way.back().request, number_); !sent) return sent;
    }
    if (under_way.empty()) return {};
    auto reply = KAZ_TRY(receive(deadline));
    if (reply && answers_first(*reply)) {
      if (auto taken = take(*reply); !taken) return taken;
      continue;
    }
    const bool later = reply && std::any_of(under_way.begin(), under_way.end(),
                                            [&](auto& one) { return one.number == reply->number; });
    const bool damaged = reply && reply->status == KZ_WRITER_DAMAGED;
    if (reply && !later && !damaged) continue;  // late: of an earlier try
    // Unanswered requests are repeated, in order; the writer recognises those already executed.
    if (auto quiet = settle(); !quiet) return quiet;
    WriterReply late;
    while (parse(late)) {
      if (!answers_first(late)) continue;
      if (auto taken = take(late); !taken) return taken;
    }
    buffer_.clear();
    if (under_way.empty()) continue;
    const bool counts = !excused(excuses);
    begin_try();
    for (UnderWay& one : under_way) {
      if (counts && ++one.tries > kTries) return no_answer(kTries);
      ++repeated_;
      if (auto sent = send(one.request, one.number); !sent) return sent;
    }
    deadline = clock_.now() + patient() * std::min(under_way.front().tries, 3);
  }
}

Result<WriterInfo> WriterLink::info(Time patience, int tries) {
  const auto reply = exchange({KZ_WRITER_INFO, {}}, patience, tries);
  if (!reply) return tl::unexpected(reply.error());
  if (reply->data.size() < 4)
    return kaz::fail(Fault::environment, "the flash writer's information is incomplete");
  WriterInfo info;
  info.protocol = reply->data[0];
  info.by_loader = reply->data[1] != 0;
  const auto id = static_cast<std::uint16_t>(reply->data[2] << 8 | reply->data[3]);
  if (id != 0xffff) info.board_id = id;
  if (info.protocol != KZ_WRITER_PROTOCOL)
    return kaz::fail(Fault::environment,
                     "the flash writer speaks protocol version " + std::to_string(info.protocol) +
                         ", but this program speaks version " + std::to_string(KZ_WRITER_PROTOCOL) +
                         "; use the writer.bin of this program");
  return info;
}

// The writer changes its rate after its reply. If the reply is lost, the rate is unknown: both are tried.
Result<void> WriterLink::set_rate(int baud, std::uint8_t brr) {
  const WriterRequest request{KZ_WRITER_RATE, {brr}};
  for (int k = 0; k < 6; ++k) {
    const auto reply = exchange(request, milliseconds(150), 1);
    if (!reply && !silent_) return tl::unexpected(reply.error());
    const int before = rate_;
    if (auto set = link_.set_baud(baud); !set) return set;
    if (auto waited = clock_.sleep_until(clock_.now() + milliseconds(2)); !waited) return waited;
    if (info(milliseconds(60), 2)) {
      rate_ = baud;
      return {};
    }
    if (auto set = link_.set_baud(before); !set) return set;
    if (auto quiet = settle(); !quiet) return quiet;
  }
  return no_answer(6);
}

Result<WriterSums> WriterLink::sums(std::uint32_t address, std::uint32_t length) {
  WriterRequest request{KZ_WRITER_SUM, {}};
  append(request.payload, address, 4);
  append(request.payload, length, 4);
  const auto reply =
      KAZ_TRY(exchange(request, milliseconds(300) + length * std::chrono::microseconds(15)));
  if (reply.status != KZ_WRITER_OK || reply.data.size() < 6)
    return kaz::fail(Fault::failed, "the board cannot compute the checksum of " +
                                        std::to_string(length) + " bytes at " +
                                        hex_address(address) + ": " + status_text(reply.status));
  const auto word = [&](std::size_t k) {
    return static_cast<std::uint16_t>(reply.data[2 * k] << 8 | reply.data[2 * k + 1]);
  };
  return WriterSums{word(0), word(1), word(2)};
}

}  // namespace kaz::host
