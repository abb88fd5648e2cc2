// Plays a recording for viewers.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/player.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "sim/runtime/simulation/recorder.h"

namespace kaz::viewer {
namespace {

using Clock = std::chrono::steady_clock;
using RecordedMessage = sim::McapRecording::Message;

constexpr std::chrono::milliseconds kCycle{10};
constexpr std::uint64_t kLead_ns = 200'000'000;  // before where a jump goes to, played at once

// Channels as this program records them: a recording that is read has its topics only.
class Schemas final : public sim::MessageTap {
 public:
  explicit Schemas(Server& server) : server_(server) {}
  void channel(std::uint16_t, const std::string& topic, const std::string& encoding,
               const std::string& schema_name, const std::string& schema_encoding,
               const std::string& schema) override {
    channels[topic] =
        server_.add_channel({0, topic, encoding, schema_name, schema_encoding, schema});
  }
  void message(std::uint16_t, std::uint64_t, std::span<const std::uint8_t>) override {}
  std::map<std::string, std::uint32_t> channels;

 private:
  Server& server_;
};

class Player {
 public:
  Player(const sim::McapRecording& recording, Server& server, Feed& feed, double speed)
      : server_(server), feed_(feed) {
    Schemas schemas(server);
    if (const auto recorder = sim::Recorder::create("", {}, &schemas))
      (*recorder)->add_all_channels();
    for (const auto& [number, topic] : recording.topics) {
      const auto known = schemas.channels.find(topic);
      channels_[number] = {
          known != schemas.channels.end() ? std::optional(known->second) : std::nullopt, topic};
    }
    for (const RecordedMessage& message : recording.messages) messages_.push_back(&message);
    // Pictures of a pair stand behind messages that are later than they are.
    std::ranges::stable_sort(messages_, {},
                             [](const RecordedMessage* message) { return message->time_ns; });
    state_.speed = speed;
    state_.status = PlaybackState::Status::playing;
    end_ns_ = recording.end_ns();
  }

  // On the server's thread.
  void hear(const Playback& wanted) {
    const std::lock_guard lock(mutex_);
    wanted_.push_back(wanted);
  }

  void run(const std::function<bool()>& stopped) {
    server_.publish_playback(state_);
    auto before = Clock::now();
    while (!stopped()) {
      std::this_thread::sleep_for(kCycle);
      const auto now = Clock::now();
      const double passed = std::chrono::duration<double, std::nano>(now - before).count();
      before = now;
      obey();
      if (state_.status != PlaybackState::Status::playing) continue;
      const auto to = state_.time_ns + static_cast<std::uint64_t>(passed * state_.speed);
      advance(std::min(to, end_ns_));
      if (to >= end_ns_) {
        state_.status = PlaybackState::Status::ended;
        report({});
      }
    }
  }

 private:
  struct Played {
    std::optional<std::uint32_t> channel;
    std::string topic;
  };

  void obey() {
    std::vector<Playback> wanted;
    {
      const std::lock_guard lock(mutex_);
      wanted.swap(wanted_);
    }
    for (const Playback& one : wanted) {
      state_.speed = one.speed;
      const bool ended = state_.status == PlaybackState::Status::ended;
      if (one.seek)
        jump(one.seek_ns);
      else if (ended && one.command == Playback::Command::play)
        jump(0);
      state_.status = one.command == Playback::Command::play ? PlaybackState::Status::playing
                                                             : PlaybackState::Status::paused;
      state_.sought = one.seek;
      report(one.request);
      state_.sought = false;
    }
  }

  void report(const std::string& request) {
    state_.request = request;
    server_.publish_playback(state_);
    state_.request.clear();
  }

  void jump(std::uint64_t to_ns) {
    to_ns = std::min(to_ns, end_ns_);
    feed_.restart();
    const std::uint64_t from = to_ns > kLead_ns ? to_ns - kLead_ns : 0;
    next_ = static_cast<std::size_t>(
        std::ranges::lower_bound(messages_, from, {},
                                 [](const RecordedMessage* message) { return message->time_ns; }) -
        messages_.begin());
    // What is sent once holds until the next: the newest before.
    std::map<std::uint16_t, const RecordedMessage*> newest;
    for (std::size_t i = 0; i < next_; ++i) {
      if (lasts(channels_[messages_[i]->channel].topic, messages_[i]->data))
        newest[messages_[i]->channel] = messages_[i];
    }
    for (const auto& [channel, message] : newest) send(*message);
    advance(to_ns);
  }

  void advance(std::uint64_t to_ns) {
    for (; next_ < messages_.size() && messages_[next_]->time_ns <= to_ns; ++next_)
      send(*messages_[next_]);
    state_.time_ns = to_ns;
  }

  void send(const RecordedMessage& message) {
    const Played& played = channels_[message.channel];
    if (played.channel)
      server_.publish(*played.channel, message.time_ns, message.data,
                      {.kept = lasts(played.topic, message.data)});
    feed_.message(played.topic, message.time_ns, message.data);
  }

  Server& server_;
  Feed& feed_;
  std::vector<const RecordedMessage*> messages_;
  std::map<std::uint16_t, Played> channels_;
  std::size_t next_ = 0;
  std::uint64_t end_ns_ = 0;
  PlaybackState state_;
  std::mutex mutex_;
  std::vector<Playback> wanted_;
};

}  // namespace

std::string no_pictures_text(const sim::McapRecording& recording) {
  if (recording.has_messages("/eyes/left") || recording.has_messages("/eyes/right"))
    return "no pictures yet";
  const std::string none = "This recording contains no pictures";
  if (recording.facts.contains("port"))
    return none + ": pictures of a robot at a port are not recorded.";
  const auto fact = [&](const char* key, const char* otherwise) {
    const auto at = recording.facts.find(key);
    return at != recording.facts.end() && at->second.size() <= 64 ? at->second : otherwise;
  };
  std::string how = "kaz sim --record FILE";
  if (recording.facts.contains("behavior"))
    how = "kaz run " + fact("behavior", "BEHAVIOR") + " --world " + fact("world", "WORLD") +
          " --eyes " + fact("eyes", "KIND") + (fact("imu", "") == "true" ? " --imu" : "") +
          " --seed " + fact("seed", "N") + " --out DIR";
  return none +
         ". kaz replay RECORDING --video film.mp4 renders the left eye's pictures. To see both "
         "eyes here, record the run again with the same options and --record-pictures: " +
         how + " --record-pictures";
}

Result<void> play(const sim::McapRecording& recording, const PlayOptions& options) {
  ViewOptions view = options.view;
  view.no_pictures = no_pictures_text(recording);
  std::string url;
  const auto server =
      KAZ_TRY(open_server(view, 0, std::max<std::uint64_t>(1, recording.end_ns()), url));
  FeedOptions feeds;
  feeds.recorded_robot = recording.has_messages("/tf");
  auto feed = KAZ_TRY(Feed::create(*server, view.robot_path, feeds));
  Player player(recording, *server, feed, view.pace > 0 ? view.pace : 1);
  server->on_playback([&player](const Playback& wanted) { player.hear(wanted); });
  if (options.on_open) options.on_open(url);
  while (view.wait && server->subscriptions() == 0 && !view.stopped())
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  player.run(view.stopped);
  server->on_playback({});
  return {};
}

}  // namespace kaz::viewer
