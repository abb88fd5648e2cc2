// Decodes tf2_msgs/TFMessage (sim/runtime/formats/ros_messages.h).
// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/recorded_poses.h"

#include <bit>
#include <cmath>
#include <map>
#include <optional>

#include "shared/base/one_line.hpp"
#include "sim/runtime/formats/little_endian.h"

namespace kaz::tools {
namespace {

using Fields = sim::LittleEndianFields;

double real(Fields& fields) {
  return std::bit_cast<double>(fields.number<std::uint64_t>());
}

// Returns nothing for an invalid transform.
std::optional<Eigen::Isometry3d> read_pose(Fields& fields) {
  constexpr double kFar_m = 1000, kRounding = 1e-6;
  Eigen::Vector3d at;
  for (double& value : at) value = real(fields);
  Eigen::Quaterniond turn;
  for (double& value : turn.coeffs()) value = real(fields);  // x y z w, as in the message
  if (!(at.cwiseAbs().maxCoeff() <= kFar_m) || !(std::abs(turn.norm() - 1) <= kRounding))
    return std::nullopt;
  return Eigen::Translation3d(at) * turn.normalized();
}

}  // namespace

Result<std::vector<RecordedPoses>> recorded_poses(const sim::McapRecording& recording,
                                                  std::span<const std::string> frames,
                                                  const std::string& name) {
  const auto unusable = [&](const std::string& why) {
    return fail(Fault::usage, name + ": " + why + "; record the run again");
  };
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < frames.size(); ++i) numbers.emplace(frames[i], i);
  std::vector<RecordedPoses> all;
  std::vector<bool> known;
  for (const auto& message : recording.messages) {
    const auto topic = recording.topics.find(message.channel);
    if (topic == recording.topics.end() || topic->second != "/tf") continue;
    RecordedPoses poses{Time(static_cast<std::int64_t>(message.time_ns)), {}};
    known.assign(frames.size(), false);
    std::size_t count = 0;
    Fields fields(message.data);
    const auto transforms = fields.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < transforms && fields.good(); ++i) {
      fields.take(12);  // sequence number and stamp
      fields.array();   // the frame `world`
      const auto frame = numbers.find(fields.text());
      const auto pose = read_pose(fields);
      if (!pose) return unusable("a pose of /tf is invalid");
      if (frame == numbers.end()) continue;
      poses.frames.resize(frames.size());
      poses.frames[frame->second] = *pose;
      count += known[frame->second] ? 0 : 1;
      known[frame->second] = true;
    }
    if (!fields.whole()) return unusable("a message of /tf does not fit its schema");
    if (count == 0) continue;
    for (const auto& [frame, number] : numbers) {
      if (!known[number])
        return fail(Fault::usage, name + ": it has no pose of `" + cut_text(frame) +
                                      "`: the robot or world has changed; record the run again");
    }
    if (!all.empty() && poses.time <= all.back().time)
      return unusable("a pose of /tf is not later than the pose before");
    all.push_back(std::move(poses));
  }
  if (all.empty()) return unusable("it has no poses of a virtual robot (/tf)");
  return all;
}

}  // namespace kaz::tools
