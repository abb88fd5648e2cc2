// Topics, calibration and pairs of pictures of other programs.
// SPDX-License-Identifier: Apache-2.0
#include "tools/vision_run/picture_topics.h"

#include <algorithm>
#include <optional>

#include "shared/base/one_line.hpp"
#include "sim/runtime/formats/picture_messages.h"
#include "vision/calibration/calibration_file.h"
#include "vision/calibration/camera_info.h"

namespace kaz::tools {
namespace {

using Recording = sim::McapRecording;

constexpr std::uint64_t kLargestSkew_ns = 5'000'000;
constexpr std::uint64_t kLatestStamp_ns = std::uint64_t{1} << 62;  // differences fit into Time
constexpr std::size_t kMostListed = 30;                            // topics in an error

std::string list_of_topics(const Recording& recording) {
  std::string text;
  std::size_t count = 0;
  for (const auto& [channel, topic] : recording.topics) {
    if (++count > kMostListed) return text + ", ...";
    text += (text.empty() ? "" : ", ") + sim::channel_text(recording, channel);
  }
  return text.empty() ? "none" : text;
}

tl::unexpected<Error> no_topics(const Recording& recording, const std::string& name,
                                const std::string& why) {
  return fail(Fault::usage, name + ": is an MCAP file of another program, " + why +
                                ": give --topics LEFT,RIGHT with topics of pictures "
                                "(sensor_msgs/Image or CompressedImage in ros1 or cdr, "
                                "foxglove.CompressedImage in json or protobuf); its topics are " +
                                list_of_topics(recording));
}

bool is_picture_topic(const Recording& recording, const std::string& topic) {
  return std::ranges::any_of(recording.topics, [&](const auto& one) {
    return one.second == topic && sim::is_picture(sim::kind_of_channel(recording, one.first));
  });
}

// The name of the right eye's topic; nullopt if the topic does not name the left eye.
std::optional<std::string> right_of(std::string topic) {
  const auto at = topic.rfind("left");
  if (at == std::string::npos) return std::nullopt;
  return topic.replace(at, 4, "right");
}

std::string parent_of(const std::string& topic) {
  return topic.substr(0, std::min(topic.rfind('/'), topic.size()));
}

// The first calibration beside `topic`: below it, or in one of the two namespaces above it, as in
// /left/image_raw/compressed and /left/camera_info.
const Recording::Message* find_camera_info(const Recording& recording, const std::string& topic) {
  std::string beside = topic;
  for (int level = 0; level < 3; ++level, beside = parent_of(beside)) {
    for (const Recording::Message& message : recording.messages) {
      if (sim::kind_of_channel(recording, message.channel) ==
              sim::PictureMessageKind::camera_info &&
          recording.topics.at(message.channel) == beside + "/camera_info")
        return &message;
    }
    if (beside.empty()) break;
  }
  return nullptr;
}

// Content of a camera_info file, from the recording. A rectified picture has no distortion, and the
// projection is its camera matrix.
Result<std::string> camera_info_in(const Recording& recording, const std::string& name,
                                   const std::string& topic, bool rectified) {
  const auto* message = find_camera_info(recording, topic);
  if (message == nullptr)
    return fail(Fault::usage, name + ": has no topic camera_info beside " + shown_text(topic) +
                                  ": give --calibration FILE");
  auto info = sim::parse_camera_info_message(recording, *message);
  if (!info)
    return fail(Fault::usage, name + ": " + sim::channel_text(recording, message->channel) + ": " +
                                  info.error().message);
  if (rectified && info->p.size() == 12) {
    const auto& p = info->p;
    info->k = {p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]};
    info->r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    info->d.clear();
    info->model.clear();
  }
  return vision::camera_info_file(*info, "recorded");
}

struct StampedMessage {
  std::uint64_t stamp_ns = 0;
  const Recording::Message* message = nullptr;
};

std::vector<StampedMessage> pictures_of(const Recording& recording, const std::string& topic,
                                        std::size_t& invalid) {
  std::vector<StampedMessage> pictures;
  for (const Recording::Message& message : recording.messages) {
    if (recording.topics.at(message.channel) != topic ||
        !sim::is_picture(sim::kind_of_channel(recording, message.channel)))
      continue;
    const auto picture = sim::parse_picture(recording, message);
    const std::uint64_t stamp_ns =
        picture && picture->stamp_ns > 0 ? picture->stamp_ns : message.time_ns;
    if (picture && stamp_ns <= kLatestStamp_ns) {
      pictures.push_back({stamp_ns, &message});
    } else {
      ++invalid;
    }
  }
  std::ranges::stable_sort(pictures, {}, &StampedMessage::stamp_ns);
  return pictures;
}

}  // namespace

Result<StereoTopics> stereo_topics(const Recording& recording, const std::string& name,
                                   const std::string& given) {
  if (!given.empty()) {
    const auto comma = given.find(',');
    if (comma == std::string::npos || given.find(',', comma + 1) != std::string::npos)
      return fail(Fault::usage,
                  "--topics '" + shown_text(given) +
                      "': must be two topics, such as /left/image_raw,/right/image_raw");
    const StereoTopics topics{given.substr(0, comma), given.substr(comma + 1)};
    for (const std::string& topic : {topics.left, topics.right})
      if (!is_picture_topic(recording, topic))
        return no_topics(recording, name, "and " + shown_text(topic) + " is no topic of pictures");
    return topics;
  }
  std::vector<StereoTopics> pairs;
  for (const auto& [channel, topic] : recording.topics) {
    const auto right = right_of(topic);
    if (!right || !is_picture_topic(recording, topic) || !is_picture_topic(recording, *right))
      continue;
    const auto same = [&, left = topic](const StereoTopics& one) { return one.left == left; };
    if (std::ranges::none_of(pairs, same)) pairs.push_back({topic, *right});
  }
  if (pairs.size() == 1) return pairs.front();
  return no_topics(recording, name,
                   pairs.empty() ? "without a left and a right topic of pictures"
                                 : "with several pairs of topics of pictures");
}

Result<RecordedEyes> recorded_eyes(const Recording& recording, const std::string& name,
                                   const StereoTopics& topics, const std::string& calibration) {
  RecordedEyes eyes;
  const auto is_rectified = [](const std::string& topic) {
    return topic.find("image_rect") != std::string::npos;
  };
  eyes.rectified = is_rectified(topics.left);
  if (eyes.rectified != is_rectified(topics.right))
    return fail(Fault::usage,
                "--topics: only one of the topics has rectified pictures "
                "(image_rect): give both topics of the same kind");
  if (!calibration.empty()) {
    eyes.calibration = KAZ_TRY(vision::read_calibration(calibration));
    return eyes;
  }
  const auto left = KAZ_TRY(camera_info_in(recording, name, topics.left, eyes.rectified));
  const auto right = KAZ_TRY(camera_info_in(recording, name, topics.right, eyes.rectified));
  eyes.calibration =
      KAZ_TRY(vision::parse_camera_info({left, right}, {name + ": camera_info of the left eye",
                                                        name + ": camera_info of the right eye"}));
  return eyes;
}

RecordedPairs pairs_in(const Recording& recording, const StereoTopics& topics) {
  RecordedPairs found;
  const auto left = pictures_of(recording, topics.left, found.invalid);
  const auto right = pictures_of(recording, topics.right, found.invalid);
  auto l = left.begin(), r = right.begin();
  while (l != left.end() && r != right.end()) {
    const bool left_first = l->stamp_ns < r->stamp_ns;
    const std::uint64_t skew = left_first ? r->stamp_ns - l->stamp_ns : l->stamp_ns - r->stamp_ns;
    const bool is_later = found.pairs.empty() || l->stamp_ns > found.pairs.back().stamp_ns;
    if (skew <= kLargestSkew_ns && !is_later) {
      ++l;
    } else if (skew <= kLargestSkew_ns) {
      found.pairs.push_back({l->stamp_ns, (l++)->message, (r++)->message});
    } else {
      ++(left_first ? l : r);
    }
  }
  found.unpaired = left.size() + right.size() - 2 * found.pairs.size();
  return found;
}

}  // namespace kaz::tools
