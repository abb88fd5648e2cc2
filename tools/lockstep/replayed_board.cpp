// The steps of a recording, and where the host leaves it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/replayed_board.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "host/link/frame_log.h"
#include "shared/protocol/frame.h"
#include "sim/runtime/formats/png_picture.h"
#include "sim/runtime/time.h"

namespace kaz::lockstep {
namespace {

constexpr std::size_t kMaxKept = 8;  // pairs that wait for the host, as sim::Eyes has it

std::string time_text(Time time) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6f s", seconds(time));
  return text;
}

std::vector<std::uint8_t> values_of(std::span<const sim::SerialByte> bytes) {
  std::vector<std::uint8_t> values;
  for (const sim::SerialByte& byte : bytes) values.push_back(byte.value);
  return values;
}

bool same(const sim::SerialByte& a, const sim::SerialByte& b) {
  return a.value == b.value && a.at == b.at && a.framing_error == b.framing_error;
}

std::string in_words(std::span<const std::uint8_t> sent, std::size_t offset,
                     const sim::SerialByte& byte) {
  return byte_in_words(sent, offset) + (byte.framing_error ? ", with a framing error" : "") +
         ", at " + time_text(sim::time_of(byte.at));
}

}  // namespace

std::string byte_in_words(std::span<const std::uint8_t> sent, std::size_t offset) {
  if (offset >= sent.size()) return "nothing";
  char value[8];
  std::snprintf(value, sizeof value, "0x%02x", sent[offset]);
  std::string text = value;
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  std::size_t start = 0;  // of the frame: its first zero
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (receiver.state <= KZ_RECEIVER_BETWEEN) start = i;
    const u8 result = kz_receive(&receiver, sent[i], 0);
    if (result == KZ_RECEIVE_MORE || i < offset) continue;
    if (start > offset) break;
    const std::string frame = host::hex(sent.subspan(start, i + 1 - start), KZ_FRAME_MAX);
    if (result != KZ_RECEIVE_FRAME) return text + " in a damaged frame " + frame;
    const std::span body(receiver.body, receiver.length);
    return text + " in `" + host::message_name(body[1]) + "` #" + std::to_string(body[2]) + " " +
           host::describe_fields(body) + ", frame " + frame;
  }
  return text + " of a frame that does not end";
}

ReplayedBoard::ReplayedBoard(const RecordedRun& run) : run_(run), line_(run.seed) {
  line_.set_faults(&run.faults);
}

Time ReplayedBoard::time() const {
  return sim::time_of(now_);
}

tl::unexpected<Error> ReplayedBoard::stop_for(Fault fault, const std::string& why) {
  error_ = Error{fault, why};
  return tl::unexpected<Error>(*error_);
}

Result<void> ReplayedBoard::stop(const std::string& why) {
  return stop_for(Fault::failed, why);
}

Result<void> ReplayedBoard::step() {
  if (error_) return tl::unexpected(*error_);
  if (now_ >= run_.end) {
    if (!run_.cut_off)
      difference_ = {time(), "the end", "the recording ends", "the host continues"};
    return stop("the recording ends at " + time_text(time()));
  }
  const sim::States end = now_ + KZ_STATES_PER_TICK;
  compare(line_.take_for_board(end), end);
  if (difference_) return stop("the host differs from the recording");

  const auto first = run_.to_host.begin() + static_cast<std::ptrdiff_t>(processed_.given);
  const auto last = std::find_if(first, run_.to_host.end(),
                                 [end](const sim::SerialByte& byte) { return byte.at > end; });
  line_.from_board({first, last});
  processed_.given += static_cast<std::size_t>(last - first);

  now_ = end;
  for (;
       processed_.exposed < run_.pairs.size() && run_.pairs[processed_.exposed].exposure <= time();
       ++processed_.exposed) {
    arriving_.push_back(&run_.pairs[processed_.exposed]);
    if (arriving_.size() > kMaxKept) arriving_.pop_front();
  }
  return {};
}

void ReplayedBoard::compare(std::span<const sim::SerialByte> arrived, sim::States end) {
  for (std::size_t k = 0;; ++k) {
    const bool expected =
        processed_.compared < run_.to_board.size() && run_.to_board[processed_.compared].at <= end;
    if (k == arrived.size() && !expected) return;
    if (k == arrived.size() || !expected || !same(arrived[k], run_.to_board[processed_.compared]))
      return differ(arrived, k);
    sent_.push_back(arrived[k].value);
    ++processed_.compared;
  }
}

// `arrived[at]`, or nothing, came in place of the recording's next byte. What both are to send after
// it determines their messages.
void ReplayedBoard::differ(std::span<const sim::SerialByte> arrived, std::size_t at) {
  auto here = std::vector<sim::SerialByte>(arrived.begin() + static_cast<std::ptrdiff_t>(at),
                                           arrived.end());
  for (const auto& byte : line_.take_for_board(std::numeric_limits<sim::States>::max()))
    here.push_back(byte);
  const std::span there = std::span(run_.to_board).subspan(processed_.compared);
  const std::size_t offset = sent_.size();
  const auto whole = [&](std::span<const sim::SerialByte> rest) {
    auto bytes = sent_;
    const auto values = values_of(rest.first(std::min<std::size_t>(rest.size(), 2 * KZ_FRAME_MAX)));
    bytes.insert(bytes.end(), values.begin(), values.end());
    return bytes;
  };
  HostDifference difference;
  sim::States first = std::numeric_limits<sim::States>::max();
  if (!there.empty()) first = there.front().at;
  if (!here.empty()) first = std::min(first, here.front().at);
  difference.time = sim::time_of(first);
  difference.where = "byte " + std::to_string(offset) + " to the board";
  difference.recorded = there.empty() ? "nothing" : in_words(whole(there), offset, there.front());
  difference.now = here.empty() ? "nothing" : in_words(whole(here), offset, here.front());
  difference_ = std::move(difference);
}

Result<std::optional<vision::StereoPair>> ReplayedBoard::next_pair() {
  if (!run_.has_pictures)
    return fail(Fault::usage, "the recording has no pictures; record with --record-pictures");
  if (arriving_.empty() || arriving_.front()->arrival > time()) return std::nullopt;
  const RecordedRun::Pair& recorded = *arriving_.front();
  arriving_.pop_front();
  auto images = std::make_shared<vision::StereoImages>();
  for (const auto& [png, image] : {std::pair(&recorded.left_png, &images->left),
                                   std::pair(&recorded.right_png, &images->right)}) {
    const auto invalid = [&](const std::string& why) {
      return stop_for(Fault::usage,
                      "pair " + std::to_string(recorded.sequence) + " of the recording: " + why);
    };
    auto decoded = sim::decode_png(*png);
    if (!decoded) return invalid(decoded.error().message);
    if (decoded->width != run_.camera.width || decoded->height != run_.camera.height)
      return invalid("the size of a picture differs from the camera's");
    *image = std::move(*decoded);
  }
  std::promise<std::shared_ptr<const vision::StereoImages>> promise;
  promise.set_value(std::move(images));
  vision::StereoPair pair;
  pair.info.sequence = recorded.sequence;
  pair.info.exposure = recorded.exposure;
  pair.info.camera = run_.camera;
  pair.images = promise.get_future().share();
  return pair;
}

void ReplayedBoard::think(const std::string& json) {
  if (run_.cut_off && error_) return;  // the run went on, but the recording did not
  const RecordedRun::Thought* recorded =
      processed_.thought < run_.thoughts.size() ? &run_.thoughts[processed_.thought] : nullptr;
  ++processed_.thought;
  if (other_thought_ || (recorded && recorded->time == time() && recorded->json == json)) return;
  const std::string then =
      recorded ? recorded->json + ", at " + time_text(recorded->time) : "nothing";
  const Time first = recorded ? std::min(recorded->time, time()) : time();
  other_thought_ = {first, "the behavior's record", then, json + ", at " + time_text(time())};
}

void ReplayedBoard::finish() {
  const bool at_cut = run_.cut_off && now_ >= run_.end;
  if ((error_ && !at_cut) || difference_) return;
  if (processed_.compared < run_.to_board.size()) return differ({}, 0);
  if (now_ < run_.end)
    difference_ = {time(), "the end",
                   "the host continues until " + time_text(sim::time_of(run_.end)),
                   "the host has ended"};
  if (processed_.thought < run_.thoughts.size() && !other_thought_)
    other_thought_ = {run_.thoughts[processed_.thought].time, "the behavior's record",
                      run_.thoughts[processed_.thought].json, "nothing"};
}

Result<void> ReplayClock::sleep_until(Time t) {
  while (board_.time() < t) {
    if (auto stepped = board_.step(); !stepped) return stepped;
  }
  return {};
}

Time ReplayLink::byte_time() const {
  return sim::time_of(KZ_STATES_PER_BYTE);
}

Result<void> ReplayLink::write(std::span<const std::uint8_t> bytes) {
  if (const auto& error = board_.error()) return tl::unexpected(*error);
  board_.write(bytes);
  return {};
}

Result<std::size_t> ReplayLink::read(std::span<std::uint8_t> bytes, Time deadline) {
  while (true) {
    if (const auto& error = board_.error()) return tl::unexpected(*error);
    const std::size_t count = board_.read(bytes);
    if (count > 0 || board_.time() >= deadline) return count;
    KAZ_TRY(board_.step());
  }
}

Result<std::optional<vision::StereoPair>> ReplayCamera::poll() {
  if (const auto& error = board_.error()) return tl::unexpected(*error);
  return board_.next_pair();
}

}  // namespace kaz::lockstep
