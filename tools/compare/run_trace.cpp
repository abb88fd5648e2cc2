// Decodes both directions of the wire.
// SPDX-License-Identifier: Apache-2.0
#include "tools/compare/run_trace.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "shared/base/number_text.hpp"
#include "shared/protocol/frame.h"
#include "shared/protocol/message_info.h"
#include "shared/protocol/messages.h"
#include "sim/runtime/time.h"
#include "tools/base/paths.h"
#include "tools/lockstep/recorded_run.h"
#include "tools/run/line_recorder.h"

namespace kaz::tools {
namespace {

using sim::SerialByte;
using sim::States;

constexpr double kTick_s = 1.0 / KZ_TICK_HZ;
constexpr double kLongest_s = 3600;
// A reply that has not come by then is none: the library has given up or repeated long before.
constexpr States kPatience = KZ_CLOCK_HZ / 2;
constexpr States kFlashPatience = 4 * KZ_CLOCK_HZ;

double seconds_of(States states) {
  return static_cast<double>(states) / static_cast<double>(KZ_CLOCK_HZ);
}

struct Frame {
  States first = 0, last = 0;  // stop bits of its first and last byte
  std::vector<std::uint8_t> body;
  std::span<const u8> fields() const { return std::span(body).subspan(KZ_HEADER_SIZE); }
};

struct Frames {
  std::vector<Frame> whole;
  int damaged = 0;
};

Frames frames_of(const std::vector<SerialByte>& bytes) {
  Frames frames;
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  States first = 0;
  for (const SerialByte& byte : bytes) {
    // A zero ends a frame or begins one: of those next to each other the last begins it.
    if (receiver.state <= KZ_RECEIVER_BETWEEN) first = byte.at;
    const u8 result = kz_receive(&receiver, byte.value, byte.framing_error ? KZ_RX_FRAMING : 0);
    if (result == KZ_RECEIVE_FRAME && receiver.length >= KZ_HEADER_SIZE)
      frames.whole.push_back(
          {first, byte.at,
           std::vector<std::uint8_t>(receiver.body, receiver.body + receiver.length)});
    else if (result != KZ_RECEIVE_MORE)
      ++frames.damaged;
  }
  return frames;
}

// Bytes that a host hands to its port leave one after the other: when each has left at the earliest.
void spread(std::vector<SerialByte>& bytes) {
  States free = 0;
  for (SerialByte& byte : bytes) {
    byte.at = std::max(byte.at, free) + KZ_STATES_PER_BYTE;
    free = byte.at;
  }
}

// Fields of a message, if its length fits.
template <class Message>
std::optional<Message> unpacked(const Frame& frame, u8 (*unpack)(Message*, const u8*, u8)) {
  Message message{};
  const auto fields = frame.fields();
  if (!unpack(&message, fields.data(), static_cast<u8>(fields.size()))) return std::nullopt;
  return message;
}

double radians(s16 angle) {
  return static_cast<double>(angle) / static_cast<double>(KZ_ANGLE_PER_RAD);
}

class Decoder {
 public:
  Decoder(RunTrace& trace, double start_s) : trace_(trace), start_s_(start_s) {}

  void decode(const Frames& out, const Frames& in) {
    trace_.damaged = out.damaged + in.damaged;
    for (const Frame& frame : out.whole) request(frame);
    for (const Frame& frame : in.whole) reply(frame);
    match(out.whole, in.whole);
    place_postures();
  }

 private:
  double at(States states) const { return seconds_of(states) - start_s_; }

  void request(const Frame& frame) {
    if (frame.body[KZ_BODY_TYPE] != KZ_TYPE_targets) return;
    const auto message = unpacked(frame, kz_unpack_targets);
    if (!message) return;
    RunTrace::Targets targets{at(frame.last), message->duration_ms * 1e-3, message->mask, {}};
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) targets.angle_rad[j] = radians(message->angle[j]);
    // A repeated request is done once; the same targets sent again mean the same.
    trace_.targets.push_back(targets);
  }

  void reply(const Frame& frame) {
    const std::uint8_t type = frame.body[KZ_BODY_TYPE];
    if (type == KZ_TYPE_refused) ++trace_.refused;
    if (type == KZ_TYPE_state_reply) {
      if (const auto state = unpacked(frame, kz_unpack_state_reply)) posture(frame, *state);
    } else if (type == KZ_TYPE_telemetry_state) {
      if (const auto state = unpacked(frame, kz_unpack_telemetry_state)) posture(frame, *state);
    }
  }

  template <class State>
  void posture(const Frame& frame, const State& state) {
    RunTrace::Posture posture;
    posture.supply_v = state.supply_mv * 1e-3;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) posture.angle_rad[j] = radians(state.angle[j]);
    measured_.push_back({state.tick, at(frame.last), posture});
    if (const u8 reason = static_cast<u8>(state.status >> 8); reason != 0) {
      const std::string text = kz_shutdown_text(reason);
      if (std::ranges::find(trace_.shutdowns, text) == trace_.shutdowns.end())
        trace_.shutdowns.push_back(text);
    }
  }

  // A tick is measured before its reply comes, by the least time that any reply has taken. After a reset of
  // the board its ticks begin anew.
  void place_postures() {
    for (std::size_t begin = 0; begin < measured_.size();) {
      std::size_t end = begin + 1;
      while (end < measured_.size() && measured_[end].tick >= measured_[end - 1].tick) ++end;
      double least = measured_[begin].arrival_s - measured_[begin].tick * kTick_s;
      for (std::size_t i = begin; i < end; ++i)
        least = std::min(least, measured_[i].arrival_s - measured_[i].tick * kTick_s);
      for (std::size_t i = begin; i < end; ++i) {
        measured_[i].posture.time_s = measured_[i].tick * kTick_s + least;
        trace_.postures.push_back(measured_[i].posture);
      }
      begin = end;
    }
  }

  // A request's reply is the first behind it of its address, type and sequence number.
  void match(const std::vector<Frame>& out, const std::vector<Frame>& in) {
    using Key = std::array<std::uint8_t, 3>;
    std::map<Key, std::vector<const Frame*>> replies;
    for (const Frame& frame : in) {
      const std::uint8_t type = frame.body[KZ_BODY_TYPE];
      if (type >= 0xC0 && type != KZ_TYPE_refused) continue;  // telemetry
      std::uint8_t request = type & 0x7F;
      if (type == KZ_TYPE_refused) {
        const auto refusal = unpacked(frame, kz_unpack_refused);
        if (!refusal) continue;
        request = refusal->request;
      }
      replies[{frame.body[KZ_BODY_ADDRESS], request, frame.body[KZ_BODY_SEQUENCE]}].push_back(
          &frame);
    }
    for (const Frame& frame : out) {
      const std::uint8_t type = frame.body[KZ_BODY_TYPE];
      if (frame.body[KZ_BODY_ADDRESS] == KZ_ADDRESS_ALL) continue;
      const States patience = kz_interrupts_service(type) ? kFlashPatience : kPatience;
      const auto found =
          replies.find({frame.body[KZ_BODY_ADDRESS], type, frame.body[KZ_BODY_SEQUENCE]});
      const Frame* reply = nullptr;
      if (found != replies.end()) {
        const auto later = std::ranges::upper_bound(found->second, frame.last, {}, &Frame::last);
        if (later != found->second.end() && (*later)->last - frame.last <= patience) reply = *later;
      }
      // Of one whose reply would have come after the recording's end nothing is known.
      if (reply != nullptr) {
        const States begun = frame.first - KZ_STATES_PER_BYTE;
        trace_.exchanges.push_back({at(begun), seconds_of(reply->last - begun)});
      } else if (!in.empty() && frame.last + patience < in.back().last) {
        ++trace_.unanswered;
      }
    }
  }

  struct Measured {
    std::uint32_t tick;
    double arrival_s;
    RunTrace::Posture posture;
  };
  RunTrace& trace_;
  double start_s_;
  std::vector<Measured> measured_;
};

// Returns null if the text is not a JSON object.
nlohmann::json object_of(const std::string& text) {
  auto value = parse_bounded_json(text);
  return value && value->is_object() ? *std::move(value) : nlohmann::json();
}

}  // namespace

Result<RunTrace> RunTrace::of(const sim::McapRecording& recording, const std::string& name) {
  auto run = KAZ_TRY(lockstep::RecordedRun::of(recording, name));
  const auto fact = [&](const char* key) {
    const auto found = recording.facts.find(key);
    return found == recording.facts.end() ? std::string() : found->second;
  };
  RunTrace trace;
  trace.name = name;
  trace.behavior = fact("behavior");
  trace.settings = fact("settings");
  trace.robot = "virtual";
  double clock_start_s = 0;
  if (const std::string port = fact("port"); !port.empty()) {
    trace.robot = port;
    const auto start = parse_number<std::int64_t>(fact(LineRecorder::kStart));
    if (!start)
      return fail(Fault::usage,
                  name + ": the start time of its clock is missing; record the run again");
    clock_start_s = static_cast<double>(*start) * 1e-9;
    spread(run.to_board);
  }

  double start_s = 0, end_s = 0;
  if (!run.thoughts.empty()) start_s = seconds(run.thoughts.front().time);
  for (const auto& thought : run.thoughts) {
    end_s = seconds(thought.time);
    const auto record = object_of(thought.json);
    const auto exposure = record.find("exposure_ns"), found = record.find("found");
    if (exposure == record.end() || !exposure->is_number_integer()) continue;
    const double exposed_s =
        static_cast<double>(exposure->get<std::int64_t>()) * 1e-9 - clock_start_s;
    trace.pictures.push_back({exposed_s - start_s, end_s - exposed_s,
                              found != record.end() && found->is_boolean() && found->get<bool>()});
  }
  Decoder(trace, start_s).decode(frames_of(run.to_board), frames_of(run.to_host));
  if (trace.postures.empty())
    return fail(Fault::usage, name +
                                  ": it contains no postures to compare; give a recording of "
                                  "`kaz run` or `kaz demo`");
  trace.duration_s = std::max(end_s - start_s, trace.postures.back().time_s);
  if (!recording.whole)
    trace.early_end = "the recording was cut off before its run ended";
  else if (const std::string by = recording.interrupted_by(); !by.empty())
    trace.early_end = "the run was interrupted (" + by + ")";
  if (!(trace.duration_s > 0 && trace.duration_s <= kLongest_s))
    return fail(Fault::usage, name +
                                  ": the duration of its run must be above 0 and at most 1 h; "
                                  "compare another run");
  return trace;
}

Result<RunTrace> RunTrace::load(const std::string& path) {
  const std::string file = recording_of(path);
  return of(KAZ_TRY(sim::McapRecording::load_run(file)), file);
}

}  // namespace kaz::tools
