// Foxglove's WebSocket protocol: parses requests of viewers, and encodes frames for them.
// SPDX-License-Identifier: Apache-2.0
//
// Sources: https://github.com/foxglove/ws-protocol (`foxglove.websocket.v1`), and the protocol of Foxglove's
// SDK (`foxglove.sdk.v1`), which adds control of a player. Viewers are not trusted, so all input is checked
// here.
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
// Accepted subprotocols, in order of preference.
inline constexpr std::array<std::string_view, 2> kSubprotocols = {kSdkProtocol,
                                                                  "foxglove.websocket.v1"};
// Maximum size of a message from a viewer, bytes.
inline constexpr std::size_t kLongestRequest = 64 << 10;
// Maximum number of entries in one request.
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
  std::string request;  // identifier, repeated in the PlaybackState that answers
};

struct PlaybackState {
  enum class Status : std::uint8_t { playing = 0, paused = 1, buffering = 2, ended = 3 };
  Status status = Status::paused;
  std::uint64_t time_ns = 0;
  double speed = 1;
  bool sought = false;
  std::string request;
};

// Channel for actions by hand, which viewers publish: JSON, {"do": LINE}. LINE is an action of HandAct
// (sim/runtime/simulation/hand_player.h), or a request for the behavior or the pace (view.h).
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
  std::string uri;                         // URI of an asset
  std::uint32_t asset_request = 0;
  Playback playback;
  std::vector<std::uint32_t> advertise;    // numbers of the viewer's channels on kHandTopic
  std::vector<std::uint32_t> unadvertise;  // channels
  std::uint32_t published = 0;             // channel of a publication
  std::string line;                        // published line
  std::vector<std::string> parameters;     // names; empty: all
  std::string parameters_request;          // identifier, repeated in the reply
};

// Parse a request. Return Fault::usage with one sentence for the viewer.
Result<Request> parse_text(std::string_view text);
Result<Request> parse_binary(std::span<const std::uint8_t> bytes);

// Returns the first of kSubprotocols in the list of a handshake, "a, b". Empty: none of them.
std::string_view chosen_subprotocol(std::string_view offered);

// Returns whether a subprotocol has this opcode for frames of a server. Only the SDK's has the state of a
// player.
bool understands(std::string_view subprotocol, std::uint8_t opcode);

// `capabilities`: as named in the SDK's protocol. Those that the other protocol lacks are left out for it,
// and so are the times of a recording.
std::string server_info(const std::string& name, const std::string& session,
                        std::string_view subprotocol, std::vector<std::string> capabilities,
                        std::uint64_t start_ns, std::uint64_t end_ns);
std::string advertisement(std::span<const Channel> channels);
std::string parameter_values(const std::map<std::string, std::string>& values,
                             const std::string& request);
enum class StatusLevel : std::uint8_t { info = 0, warning = 1, error = 2 };
std::string status(StatusLevel level, const std::string& sentence);
// Returns the beginning of a message's frame. Its data follow.
Bytes message_head(std::uint32_t subscription, std::uint64_t time_ns);
Bytes time_frame(std::uint64_t time_ns);
// Returns the beginning of an answer to fetchAsset. Without an error, the file's bytes follow.
Bytes asset_head(std::uint32_t request, const std::string& error);
Bytes playback_frame(const PlaybackState& state);

}  // namespace kaz::watch
