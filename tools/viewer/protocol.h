// Foxglove's WebSocket protocol: parses requests from viewers, and encodes frames for viewers.
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

namespace kaz::viewer {

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
  std::string request;  // identifier; repeated in the PlaybackState that answers the request
};

struct PlaybackState {
  enum class Status : std::uint8_t { playing = 0, paused = 1, buffering = 2, ended = 3 };
  Status status = Status::paused;
  std::uint64_t time_ns = 0;
  double speed = 1;
  bool sought = false;
  std::string request;
};

// Topic on which viewers publish manual actions as JSON, {"do": LINE}. LINE is an action of HandAct
// (sim/runtime/simulation/hand_player.h), or a request to change the behavior or the pace (view.h).
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
  std::vector<std::uint32_t> unsubscribe;  // numbers of subscriptions
  std::string uri;                         // URI of the requested asset
  std::uint32_t asset_request = 0;
  Playback playback;
  std::vector<std::uint32_t> advertise;    // numbers of the viewer's channels on kHandTopic
  std::vector<std::uint32_t> unadvertise;  // numbers of the viewer's channels
  std::uint32_t published = 0;             // number of the channel on which the viewer published
  std::string line;                        // published line of text
  std::vector<std::string> parameters;  // names of the requested parameters; empty: all parameters
  std::string parameters_request;       // identifier of the request; repeated in the reply
};

// Parse a request. If the request is invalid, return Fault::usage with one sentence for the viewer.
Result<Request> parse_text(std::string_view text);
Result<Request> parse_binary(std::span<const std::uint8_t> bytes);

// Returns the first of kSubprotocols that a handshake's list, such as "a, b", contains. Empty: the list
// contains none of kSubprotocols.
std::string_view chosen_subprotocol(std::string_view offered);

// Returns whether the server may send frames with this opcode in a subprotocol. Only the subprotocol of the
// SDK has frames with the state of a player.
bool understands(std::string_view subprotocol, std::uint8_t opcode);

// Returns the message serverInfo. `capabilities`: names in the SDK's protocol. If `subprotocol` is not the
// SDK's protocol, capabilities that the subprotocol does not have are left out. The times of a recording are
// then also left out.
std::string server_info(const std::string& name, const std::string& session,
                        std::string_view subprotocol, std::vector<std::string> capabilities,
                        std::uint64_t start_ns, std::uint64_t end_ns);
std::string advertisement(std::span<const Channel> channels);
std::string parameter_values(const std::map<std::string, std::string>& values,
                             const std::string& request);
enum class StatusLevel : std::uint8_t { info = 0, warning = 1, error = 2 };
std::string status(StatusLevel level, const std::string& sentence);
// Returns the first part of a message frame. The data of the message must follow.
Bytes message_head(std::uint32_t subscription, std::uint64_t time_ns);
Bytes time_frame(std::uint64_t time_ns);
// Returns the first part of an answer to fetchAsset. If `error` is empty, the bytes of the file must follow.
Bytes asset_head(std::uint32_t request, const std::string& error);
Bytes playback_frame(const PlaybackState& state);

}  // namespace kaz::viewer
