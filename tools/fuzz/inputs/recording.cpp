// Recordings: the file, what kaz replay takes out of it, and the replayed board itself.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/simulation/hand_player.h"
#include "tools/compare/comparison.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/lockstep/recorded_run.h"
#include "tools/lockstep/replayed_board.h"
#include "tools/replay/message_fields.h"
#include "tools/replay/recorded_backend.h"
#include "tools/replay/recorded_poses.h"

namespace kaz::fuzz {
namespace {

constexpr int kSteps = 100;  // ms

Complaint judge(const lockstep::RecordedRun& run) {
  if (run.camera_latency < Time::zero()) return "a picture arrives before its exposure";
  if (!run.has_pictures) return std::nullopt;
  const vision::CameraModel& c = run.camera;
  if (c.width < 1 || c.height < 1 || !(std::isfinite(c.fx) && c.fx > 0) ||
      !(std::isfinite(c.fy) && c.fy > 0) || !std::isfinite(c.cx) || !std::isfinite(c.cy) ||
      !std::isfinite(c.baseline_m))
    return "an invalid camera model was read";
  return std::nullopt;
}

Complaint play(const lockstep::RecordedRun& run) {
  lockstep::ReplayedBoard board(run);
  const std::uint8_t request[] = {0, 4, 1, 1, 1, 0x80, 0x80, 0x80, 0};
  board.write(request);
  std::uint8_t reply[256];
  for (int k = 0; k < kSteps; ++k) {
    if (auto stepped = board.step(); !stepped) {
      if (stepped.error().message.empty()) return "an error without a message";
      break;
    }
    (void)board.read(reply);
    auto pair = board.next_pair();
    if (!pair && pair.error().message.empty()) return "an error without a message";
    if (pair && *pair && (*pair)->images.get() == nullptr) return "a pair without pictures";
    board.think("{}");
  }
  board.finish();
  return std::nullopt;
}

}  // namespace

Complaint try_recording(Bytes bytes) {
  const auto recording = sim::McapRecording::parse(bytes, "case.mcap");
  if (!recording) return judge_error(recording.error(), "case.mcap");
  if (recording->duration_ns() > recording->end_ns()) return "a duration is negative";
  if (const auto of_kaz = recording->check_run("case.mcap"); !of_kaz)
    return judge_error(of_kaz.error(), "case.mcap");
  (void)recording->has_messages("/eyes/left");
  for (const auto& [time_ns, line] : tools::recorded_acts(*recording))
    (void)sim::parse_hand(line, Time(static_cast<std::int64_t>(time_ns / 2)));
  const auto backend = tools::recorded_backend(*recording, "case.mcap");
  if (!backend) {
    if (auto wrong = judge_error(backend.error(), "case.mcap")) return wrong;
  }
  const sim::McapRecording::Message* before = nullptr;
  for (const auto& message : recording->messages) {
    const auto topic = recording->topics.find(message.channel);
    if (topic != recording->topics.end() && before != nullptr) {
      (void)tools::field_difference(topic->second, before->data, message.data);
      if (tools::field_difference(topic->second, message.data, message.data))
        return "a comparison of a message with itself found a difference";
    }
    before = &message;
  }
  (void)tools::recorded_phases(*recording);
  const std::vector<std::string> frames{"trunk", "ball::link"};
  const auto poses = tools::recorded_poses(*recording, frames, "case.mcap");
  if (!poses) {
    if (auto wrong = judge_error(poses.error(), "case.mcap")) return wrong;
  } else {
    for (const tools::RecordedPoses& one : *poses)
      for (const Eigen::Isometry3d& pose : one.frames)
        if (!pose.matrix().allFinite()) return "a pose is not finite";
  }
  const auto trace = tools::RunTrace::of(*recording, "case.mcap");
  if (!trace) {
    if (auto wrong = judge_error(trace.error(), "case.mcap")) return wrong;
  } else if (tools::compare(*trace, *trace).differing() != 0) {
    return "a comparison of a run with itself found a difference";
  }
  const auto run = lockstep::RecordedRun::of(*recording, "case.mcap");
  if (!run) return judge_error(run.error(), "case.mcap");
  if (auto wrong = judge(*run)) return wrong;
  return play(*run);
}

}  // namespace kaz::fuzz
