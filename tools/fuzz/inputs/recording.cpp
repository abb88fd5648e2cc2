// Recordings: the file, what kaz replay takes out of it, and the replayed board itself.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/formats/picture_messages.h"
#include "sim/runtime/simulation/hand_player.h"
#include "tools/compare/comparison.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/lockstep/recorded_run.h"
#include "tools/lockstep/replayed_board.h"
#include "tools/replay/message_fields.h"
#include "tools/replay/recorded_backend.h"
#include "tools/replay/recorded_poses.h"
#include "tools/vision_run/picture_topics.h"

namespace kaz::fuzz {
namespace {

constexpr int kSteps = 100;  // ms
constexpr std::uint64_t kMostPixels = 100'000;

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

// Reads pictures of recordings of other programs, as `kaz vision run` does.
Complaint judge_pictures(const sim::McapRecording& recording) {
  for (const auto& message : recording.messages) {
    const auto kind = sim::kind_of_channel(recording, message.channel);
    if (kind == sim::PictureMessageKind::camera_info)
      (void)sim::parse_camera_info_message(recording, message);
    if (!sim::is_picture(kind)) continue;
    const auto parsed = sim::parse_picture(recording, message);
    if (!parsed || std::uint64_t{parsed->width} * parsed->height > kMostPixels) continue;
    const auto image = sim::decode_message_picture(*parsed, "case.mcap");
    if (!image) {
      if (auto wrong = judge_error(image.error(), "case.mcap")) return wrong;
    } else if (image->rgb.size() != std::size_t{3} * static_cast<std::size_t>(image->width) *
                                        static_cast<std::size_t>(image->height)) {
      return "a picture has a wrong number of pixels";
    }
  }
  const auto topics = tools::stereo_topics(recording, "case.mcap", "");
  if (!topics) return judge_error(topics.error(), "case.mcap");
  const auto eyes = tools::recorded_eyes(recording, "case.mcap", *topics, "");
  if (!eyes) return judge_error(eyes.error(), "case.mcap");
  if (!(eyes->calibration.rectified.baseline_m > 0)) return "an invalid camera model was read";
  const auto pairs = tools::pairs_in(recording, *topics).pairs;
  for (std::size_t k = 1; k < pairs.size(); ++k)
    if (pairs[k].stamp_ns <= pairs[k - 1].stamp_ns) return "the times of pairs do not increase";
  return std::nullopt;
}

}  // namespace

Complaint try_recording(Bytes bytes) {
  const auto recording = sim::McapRecording::parse(bytes, "case.mcap");
  if (!recording) return judge_error(recording.error(), "case.mcap");
  if (auto wrong = judge_pictures(*recording)) return wrong;
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
