// What viewers of a run send, and messages of a recording that is played for them.
// SPDX-License-Identifier: Apache-2.0
#include <strings.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "hil/fuzz/choices.h"
#include "host/behavior/pose_request.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/viewer/entry.h"
#include "tools/viewer/feed.h"
#include "tools/viewer/protocol.h"
#include "tools/viewer/view.h"

namespace kaz::fuzz {
namespace {

constexpr std::string_view kTopics[] = {
    "/truth/joints", "/truth/ball", "/wire/to_board", "/wire/to_host", "/board/pins",
    "/behavior",     "/tf"};

Complaint judge(const Result<viewer::Request>& request) {
  if (!request) {
    const std::string& sentence = request.error().message;
    if (sentence.empty() || sentence.find('\n') != std::string::npos)
      return "a refusal is not one line: " + sentence;
    return std::nullopt;
  }
  if (request->subscribe.size() > viewer::kMostEntries ||
      request->unsubscribe.size() > viewer::kMostEntries)
    return "a request asks for more than is allowed";
  if (request->line.size() > viewer::kLongestLine) return "a line is longer than is allowed";
  if (const auto act = sim::parse_hand(request->line, Time::zero())) {
    if (!act->vector.allFinite() || act->vector.cwiseAbs().maxCoeff() > sim::HandAct::kMaxPlace)
      return "a position or vector is out of range";
  }
  if (const auto wanted = behavior::parse_pose_request(request->line)) {
    if (!(std::abs(wanted->angle_rad) < 3.2)) return "a requested joint angle is out of range";
  }
  if (request->kind == viewer::Request::Kind::playback &&
      !(request->playback.speed > 0.009 && request->playback.speed < 101))
    return "a player's speed is out of range";
  return std::nullopt;
}

// Hears a recording's messages; it has a server that nobody is connected to.
Complaint play(std::string_view topic, Bytes bytes) {
  static const auto server = [] {
    viewer::ServerOptions options;
    options.port = 0;
    return viewer::Server::open(options);
  }();
  static auto feed = viewer::Feed::create(**server, KAZ_FUZZ_ROBOT);
  if (!feed) return feed.error().message;
  feed->message(topic, 1'000'000, bytes);
  feed->restart();
  return std::nullopt;
}

}  // namespace

// The first byte: a WebSocket, and --view-open. Then lines: method, target, Host, Origin, subprotocols.
Complaint try_entry(Bytes bytes) {
  static const viewer::Access kAccess = [] {
    viewer::Access access;
    access.token = "0123456789abcdef";
    access.names = {"robot"};
    access.page["/index.html"] = {"text/html", {'p'}};
    access.robot["/robot/kaz.urdf"] = {"application/xml", {'u'}};
    return access;
  }();
  if (bytes.empty()) return std::nullopt;
  viewer::Access access = kAccess;
  access.open = (bytes[0] & 2) != 0;
  const std::string text = text_of(bytes.subspan(1));
  std::array<std::string_view, 5> lines;
  std::string_view rest = text;
  for (auto& line : lines) {
    line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
  }
  const auto& [method, target, host, origin, subprotocols] = lines;
  const viewer::Answer answer =
      viewer::answer_to({method, target, host, origin, subprotocols, (bytes[0] & 1) != 0}, access);
  if (answer.status >= 400) {
    if (answer.sentence.find('\n') + 1 != answer.sentence.size() || answer.sentence.size() < 5)
      return "a refusal is not one line: " + std::string(answer.sentence);
    return std::nullopt;
  }
  const std::string name(host.substr(0, host.rfind(':')));
  if (name.find_first_not_of("0123456789abcdefABCDEF.:[]") != name.npos &&
      strcasecmp(name.c_str(), "localhost") != 0 && strcasecmp(name.c_str(), "robot") != 0)
    return "a foreign Host header was accepted: " + name;
  const bool token = target.find("token=" + access.token) != target.npos;
  const bool foreign = origin.starts_with("http") && !origin.ends_with(host);
  if (answer.control && !token) return "a client without the token can control the run";
  if (answer.status == 101 && answer.subprotocol.empty())
    return "a viewer without a subprotocol was accepted";
  if (answer.status != 101 && answer.file == nullptr) return "an answer without a file";
  const bool page = answer.file == &access.page.at("/index.html");
  if (!page && !token && (!access.open || foreign))
    return "a client without the token can read data";
  return std::nullopt;
}

Complaint try_viewer(Bytes bytes) {
  if (bytes.empty()) return std::nullopt;
  const unsigned kind = bytes[0] % 10;
  const Bytes rest = bytes.subspan(1);
  if (kind == 0) return judge(viewer::parse_binary(rest));
  if (kind == 1) {
    const std::string text = text_of(rest);
    const std::string_view chosen = viewer::chosen_subprotocol(text);
    if (!chosen.empty() && text.find(chosen) == std::string::npos)
      return "a subprotocol was chosen that was not offered";
    return std::nullopt;
  }
  if (kind == 2) return judge(viewer::parse_text(text_of(rest)));
  return play(kTopics[kind - 3], rest);
}

}  // namespace kaz::fuzz
