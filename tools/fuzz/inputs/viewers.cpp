// What viewers of a run send, and messages of a recording that is played for them.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "hil/fuzz/choices.h"
#include "host/behavior/pose_request.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/view/feed.h"
#include "tools/view/protocol.h"
#include "tools/view/view.h"

namespace kaz::fuzz {
namespace {

constexpr std::string_view kTopics[] = {"/truth/joints", "/truth/ball", "/wire/to_board",
                                        "/wire/to_host", "/board/pins", "/behavior"};

Complaint judge(const Result<watch::Request>& request) {
  if (!request) {
    const std::string& sentence = request.error().message;
    if (sentence.empty() || sentence.find('\n') != std::string::npos)
      return "a refusal is not one line: " + sentence;
    return std::nullopt;
  }
  if (request->subscribe.size() > watch::kMostEntries ||
      request->unsubscribe.size() > watch::kMostEntries)
    return "a request asks for more than is allowed";
  if (request->line.size() > watch::kLongestLine) return "a line is longer than is allowed";
  if (const auto act = sim::parse_hand(request->line, Time::zero())) {
    if (!act->vector.allFinite() || act->vector.cwiseAbs().maxCoeff() > sim::HandAct::kMaxPlace)
      return "a hand reaches too far";
  }
  if (const auto wanted = behavior::parse_pose_request(request->line)) {
    if (!(std::abs(wanted->angle_rad) < 3.2)) return "a joint is to turn too far";
  }
  if (request->kind == watch::Request::Kind::playback &&
      !(request->playback.speed > 0.009 && request->playback.speed < 101))
    return "a player's speed is out of range";
  return std::nullopt;
}

// Hears a recording's messages; it has a server that nobody is connected to.
Complaint play(std::string_view topic, Bytes bytes) {
  static const auto server = [] {
    watch::ServerOptions options;
    options.port = 0;
    return watch::Server::open(options);
  }();
  static auto feed = watch::Feed::create(**server, KAZ_FUZZ_ROBOT);
  if (!feed) return feed.error().message;
  feed->message(topic, 1'000'000, bytes);
  feed->restart();
  return std::nullopt;
}

}  // namespace

Complaint try_viewer(Bytes bytes) {
  if (bytes.empty()) return std::nullopt;
  const unsigned kind = bytes[0] % 10;
  const Bytes rest = bytes.subspan(1);
  if (kind == 0) return judge(watch::parse_binary(rest));
  if (kind == 1) {
    const std::string text = text_of(rest);
    const std::string_view chosen = watch::chosen_subprotocol(text);
    if (!chosen.empty() && text.find(chosen) == std::string::npos)
      return "a subprotocol was chosen that was not offered";
    return std::nullopt;
  }
  if (kind == 2) return judge(watch::parse_text(text_of(rest)));
  return play(kTopics[kind - 3], rest);
}

}  // namespace kaz::fuzz
