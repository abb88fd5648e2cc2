// Foxglove's WebSocket protocol: what viewers send, and the frames that they get.
// SPDX-License-Identifier: Apache-2.0
//
// https://github.com/foxglove/ws-protocol (`foxglove.websocket.v1`), and that of Foxglove's SDK, which adds
// the control of a player (`foxglove.sdk.v1`). Viewers are not trusted: everything is checked here.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.hpp"

namespace kaz::watch {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::string_view kSdkProtocol = "foxglove.sdk.v1";
// Those that are accepted, the preferred one first.
inline constexpr std::array<std::string_view, 2> kSubprotocols = {kSdkProtocol,
                                                                  "foxglove.websocket.v1"};
// The longest message that a viewer may send.
inline constexpr std::size_t kLongestRequest = 64 << 10;
// The most that one message may ask for.
inline constexpr std::size_t kMostEntries = 1024;

struct Channel {
  std::uint32_t id = 0;
  std::string topic, encoding, schema_name, schema_encoding, schema;
};

struct Subscription {
  std::uint32_t id = 0, channel = 0;
};

struct Playback {
  enum class Command : std::uint8_t { play = 0, pause = 1 };
  Command command = Command::play;
  double speed = 1;  // 0.01 to 100
  bool seek = false;
  std::uint64_t seek_ns = 0;
  std::string request;  // its name, which the state that answers repeats
};

struct PlaybackState {
  enum class Status : std::uint8_t { playing = 0, paused = 1, buffering = 2, ended = 3 };
  Status status = Status::paused;
  std::uint64_t time_ns = 0;
  double speed = 1;
  bool sought = false;
  std::string request;
};

// The channel on which viewers say what is to be done by hand: JSON, {"do": LINE} with a line of HandAct
// (sim/runtime/simulation/hand_player.h) or of the pace (view.h).
inline constexpr std::string_view kHandTopic = "/hand";
inline constexpr std::size_t kLongestLine = 32 << 10;

struct Request {
  enum class Kind {
    subscribe,
    unsubscribe,
    fetch_asset,
    playback,
    parameters,
    watch_parameters,
    advertise,
    unadvertise,
    publish
  };
  Kind kind = Kind::subscribe;
  std::vector<Subscription> subscribe;
  std::vector<std::uint32_t> unsubscribe;  // subscriptions
  std::string uri;                         // of an asset
  std::uint32_t asset_request = 0;
  Playback playback;
  std::vector<std::uint32_t> advertise;    // the viewer's numbers of its channels kHandTopic
  std::vector<std::uint32_t> unadvertise;  // its channels
  std::uint32_t published = 0;             // its channel
  std::string line;                        // that it published there
  std::vector<std::string> parameters;     // names; none: all
  std::string parameters_request;          // its name, which the reply repeats
};

// Errors: one sentence for the viewer.
Result<Request> parse_text(std::string_view text);
Result<Request> parse_binary(std::span<const std::uint8_t> bytes);

// The first of kSubprotocols that is in the list of a handshake, "a, b"; empty if there is none.
std::string_view chosen_subprotocol(std::string_view offered);

// Whether the protocol of that name has this opcode among the frames that a server sends. Only the SDK's
// has the state of a player.
bool understands(std::string_view subprotocol, std::uint8_t opcode);

// `capabilities` in the words of the SDK's protocol; those that the other one lacks are left out for it, as
// are the times of a recording.
std::string server_info(const std::string& name, const std::string& session,
                        std::string_view subprotocol, std::vector<std::string> capabilities,
                        std::uint64_t start_ns, std::uint64_t end_ns);
std::string advertisement(std::span<const Channel> channels);
std::string parameter_values(const std::map<std::string, std::string>& values,
                             const std::string& request);
enum class StatusLevel : std::uint8_t { info = 0, warning = 1, error = 2 };
std::string status(StatusLevel level, const std::string& sentence);
// The beginning of a message's frame: its data follow.
Bytes message_head(std::uint32_t subscription, std::uint64_t time_ns);
Bytes time_frame(std::uint64_t time_ns);
// The beginning of a frame that answers fetchAsset: without an error the file's bytes follow.
Bytes asset_head(std::uint32_t request, const std::string& error);
Bytes playback_frame(const PlaybackState& state);

}  // namespace kaz::watch
