// Decodes the channels of a recording that the host had to do with (sim/runtime/simulation/recorder.cpp).
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/recorded_run.h"

#include <algorithm>
#include <map>
#include <sstream>

#include "shared/base/number_text.hpp"
#include "sim/runtime/formats/little_endian.h"
#include "sim/runtime/time.h"
#include "vision/calibration/valid_camera.h"

namespace kaz::lockstep {
namespace {

using Message = sim::McapRecording::Message;
using Bytes = sim::LittleEndianFields::Bytes;
using Fields = sim::LittleEndianFields;

// Bytes of one millisecond, which ends at the message's time. They come one after the other.
bool add_bytes(const Message& message, std::vector<sim::SerialByte>& to) {
  const sim::States start =
      sim::states_of(Time(static_cast<std::int64_t>(message.time_ns))) - KZ_STATES_PER_TICK;
  Fields fields(message.data);
  const Bytes values = fields.array();
  const auto times = fields.take(2 * std::size_t{fields.number<std::uint32_t>()});
  const Bytes errors = fields.array();
  if (!fields.whole() || times.size() != 2 * values.size() || errors.size() != values.size())
    return false;
  Fields time(times);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const sim::States after_start = time.number<std::uint16_t>();
    const sim::SerialByte byte{values[i], start + after_start, errors[i] != 0};
    if (after_start > KZ_STATES_PER_TICK || byte.at < 0 || (!to.empty() && byte.at < to.back().at))
      return false;
    to.push_back(byte);
  }
  return true;
}

bool add_picture(const Message& message, bool left,
                 std::map<std::uint64_t, RecordedRun::Pair>& pairs) {
  Fields fields(message.data);
  RecordedRun::Pair pair;
  pair.sequence = fields.number<std::uint32_t>();
  const auto seconds = fields.number<std::uint32_t>();
  const auto nanoseconds = fields.number<std::uint32_t>();
  pair.exposure = std::chrono::seconds(seconds) + Time(nanoseconds);
  pair.arrival = Time(static_cast<std::int64_t>(message.time_ns));
  fields.array();  // which eye
  fields.array();  // "png"
  const Bytes png = fields.array();
  if (!fields.whole() || nanoseconds >= 1'000'000'000 || pair.arrival < pair.exposure) return false;
  RecordedRun::Pair& kept = pairs.try_emplace(pair.sequence, pair).first->second;
  (left ? kept.left_png : kept.right_png).assign(png.begin(), png.end());
  return true;
}

// "width height fx fy cx cy baseline_m latency_s"
bool read_camera(const std::string& text, RecordedRun& run) {
  constexpr double kMaxLatency_s = 10;
  std::istringstream from(text);
  double latency_s = 0;
  vision::CameraModel& c = run.camera;
  from >> c.width >> c.height >> c.fx >> c.fy >> c.cx >> c.cy >> c.baseline_m >> latency_s;
  if (from.fail() || !vision::valid_camera(c) || !(latency_s >= 0 && latency_s <= kMaxLatency_s))
    return false;
  run.camera_latency = from_seconds(latency_s);
  return true;
}

// Drops what a recording that was cut off holds only in part. A step is recorded in a row, its pins
// among the first, and what the host enters stands behind it: all of a step is there if the pins of the
// next are. A pair is recorded some exposures later than it arrives; so pairs are all there only up to
// the arrival of the last one that is.
void end_where_it_is_whole(RecordedRun& run) {
  run.end -= KZ_STATES_PER_TICK;
  while (!run.pairs.empty() &&
         (run.pairs.back().left_png.empty() || run.pairs.back().right_png.empty()))
    run.pairs.pop_back();
  if (run.has_pictures) {
    const Time known = run.pairs.empty() ? Time(0) : run.pairs.back().arrival;
    run.end = std::min(run.end, sim::states_of(known) / KZ_STATES_PER_TICK * KZ_STATES_PER_TICK);
  }
  run.end = std::max<sim::States>(run.end, 0);
  const auto later = [&](const sim::SerialByte& byte) { return byte.at > run.end; };
  std::erase_if(run.to_board, later);
  std::erase_if(run.to_host, later);
  std::erase_if(run.thoughts, [&](const RecordedRun::Thought& thought) {
    return sim::states_of(thought.time) > run.end;
  });
}

}  // namespace

Result<RecordedRun> RecordedRun::of(const sim::McapRecording& recording, const std::string& name) {
  const auto unusable = [&](const std::string& why) {
    return fail(Fault::usage, name + ": " + why + "; record the run again");
  };
  if (recording.damaged_chunks > 0) return unusable("a chunk is damaged");
  RecordedRun run;
  run.cut_off = recording.ends_early();
  run.interrupted_by = recording.interrupted_by();
  const auto fact = [&](const std::string& key) {
    const auto found = recording.facts.find(key);
    return found == recording.facts.end() ? std::string() : found->second;
  };
  if (const std::string text = fact("seed"); !text.empty()) {
    const auto seed = parse_number<std::uint64_t>(text);
    if (!seed) return unusable("its seed must be an unsigned 64-bit integer");
    run.seed = *seed;
  }
  auto faults = faults::Schedule::parse(fact("faults"), name + ", its faults");
  if (!faults) return tl::unexpected(faults.error());
  run.faults = std::move(*faults);

  std::map<std::uint64_t, Pair> pairs;
  for (const Message& message : recording.messages) {
    const std::string& topic = recording.topics.at(message.channel);
    const auto time = Time(static_cast<std::int64_t>(message.time_ns));
    bool valid = true;
    if (topic == "/wire/to_board") valid = add_bytes(message, run.to_board);
    if (topic == "/wire/to_host") valid = add_bytes(message, run.to_host);
    if (topic == "/eyes/left") valid = add_picture(message, true, pairs);
    if (topic == "/eyes/right") valid = add_picture(message, false, pairs);
    if (topic == "/behavior")
      run.thoughts.push_back({time, std::string(message.data.begin(), message.data.end())});
    if (topic == "/board/pins") run.end = std::max(run.end, sim::states_of(time));
    if (!valid) return unusable("a message of " + topic + " does not fit its schema");
  }
  // One made at a port has no steps of a world: all that is there is whole.
  if (!recording.has_messages("/board/pins")) {
    run.end =
        sim::states_of(Time(static_cast<std::int64_t>(recording.end_ns()))) + KZ_STATES_PER_TICK;
  }
  for (auto& [sequence, pair] : pairs) run.pairs.push_back(std::move(pair));
  run.has_pictures = !run.pairs.empty();
  if (run.cut_off) end_where_it_is_whole(run);
  for (std::size_t i = 0; i < run.pairs.size(); ++i) {
    const Pair& pair = run.pairs[i];
    if (pair.left_png.empty() || pair.right_png.empty())
      return unusable("pair " + std::to_string(pair.sequence) + " lacks a picture");
    if (i > 0 && pair.exposure <= run.pairs[i - 1].exposure)
      return unusable("pair " + std::to_string(pair.sequence) +
                      " is not later than the pair before");
  }
  if (run.has_pictures && !read_camera(fact("camera"), run))
    return unusable("it has pictures, but no valid camera model");
  if (run.cut_off && run.end == 0) return unusable("it was cut off before its first complete step");
  return run;
}

}  // namespace kaz::lockstep
