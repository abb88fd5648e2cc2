// Decodes the channels of a recording that the host had to do with (sim/runtime/recorder.cpp).
// SPDX-License-Identifier: Apache-2.0
#include "tools/lockstep/recorded_run.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <span>
#include <sstream>

#include "sim/runtime/little_endian.h"
#include "sim/runtime/time.h"

namespace kaz::lockstep {
namespace {

using Message = sim::McapRecording::Message;
using Bytes = sim::LittleEndianFields::Bytes;
using Fields = sim::LittleEndianFields;

// Bytes of one millisecond, which ends at the message's time.
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
  for (std::size_t i = 0; i < values.size(); ++i)
    to.push_back({values[i], start + time.number<std::uint16_t>(), errors[i] != 0});
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
  if (!fields.whole()) return false;
  RecordedRun::Pair& kept = pairs.try_emplace(pair.sequence, pair).first->second;
  (left ? kept.left_png : kept.right_png).assign(png.begin(), png.end());
  return true;
}

// "width height fx fy cx cy baseline_m latency_s"
bool read_camera(const std::string& text, RecordedRun& run) {
  std::istringstream from(text);
  double latency_s = 0;
  vision::CameraModel& c = run.camera;
  from >> c.width >> c.height >> c.fx >> c.fy >> c.cx >> c.cy >> c.baseline_m >> latency_s;
  if (from.fail() || c.width < 1 || c.height < 1 || c.width > 4096 || c.height > 4096 ||
      !(latency_s >= 0 && latency_s <= 10))
    return false;
  for (const double number : {c.fx, c.fy, c.cx, c.cy, c.baseline_m}) {
    if (!std::isfinite(number)) return false;
  }
  run.camera_latency = from_seconds(latency_s);
  return c.fx > 0 && c.fy > 0;
}

}  // namespace

Result<RecordedRun> RecordedRun::of(const sim::McapRecording& recording) {
  const auto unusable = [](const std::string& why) {
    return fail(Fault::usage, "the recording cannot be run again: " + why);
  };
  if (!recording.whole || recording.damaged_chunks > 0)
    return unusable(std::string(recording.whole ? "a chunk is damaged" : "its end is missing") +
                    "; record the run again");
  RecordedRun run;
  const auto fact = [&](const std::string& name) {
    const auto found = recording.facts.find(name);
    return found == recording.facts.end() ? std::string() : found->second;
  };
  run.seed = std::strtoull(fact("seed").c_str(), nullptr, 10);
  auto faults = faults::Schedule::parse(fact("faults"), "the recording's faults");
  if (!faults) return tl::unexpected(faults.error());
  run.faults = std::move(*faults);

  std::map<std::uint64_t, Pair> pairs;
  for (const Message& message : recording.messages) {
    const auto found = recording.topics.find(message.channel);
    const std::string topic = found == recording.topics.end() ? "" : found->second;
    const auto time = Time(static_cast<std::int64_t>(message.time_ns));
    bool sound = true;
    if (topic == "/wire/to_board") sound = add_bytes(message, run.to_board);
    if (topic == "/wire/to_host") sound = add_bytes(message, run.to_host);
    if (topic == "/eyes/left") sound = add_picture(message, true, pairs);
    if (topic == "/eyes/right") sound = add_picture(message, false, pairs);
    if (topic == "/behavior")
      run.thoughts.push_back({time, std::string(message.data.begin(), message.data.end())});
    if (topic == "/board/pins") run.end = std::max(run.end, sim::states_of(time));
    if (!sound) return unusable("a message of " + topic + " does not fit its schema");
  }
  for (auto& [sequence, pair] : pairs) {
    if (pair.left_png.empty() || pair.right_png.empty())
      return unusable("pair " + std::to_string(sequence) + " lacks a picture");
    run.pairs.push_back(std::move(pair));
  }
  run.has_pictures = !run.pairs.empty();
  if (run.has_pictures && !read_camera(fact("camera"), run))
    return unusable("it has pictures, but does not say of which camera");
  return run;
}

}  // namespace kaz::lockstep
