// Foxglove's WebSocket protocol.
// SPDX-License-Identifier: Apache-2.0
#include "tools/viewer/protocol.h"

#include <algorithm>
#include <bit>

#include <nlohmann/json.hpp>

#include "shared/base/bounded_json.hpp"
#include "sim/runtime/formats/little_endian.h"

namespace kaz::viewer {
namespace {

using nlohmann::json;
using sim::LittleEndian;
using sim::LittleEndianFields;

constexpr std::uint8_t kPublish = 1, kPlaybackRequest = 3;  // opcodes of viewers' frames
constexpr std::uint8_t kMessage = 1, kTime = 2, kAsset = 4, kPlaybackState = 5;  // of the server's
constexpr std::size_t kLongestName = 4096;

Result<std::uint32_t> number_of(const json& object, const char* name) {
  const auto at = object.is_object() ? object.find(name) : object.end();
  if (!object.is_object() || at == object.end() || !at->is_number_unsigned() ||
      at->get<std::uint64_t>() > 0xffffffff)
    return fail(Fault::usage,
                std::string("`") + name + "` must be a whole number from 0 to 4294967295");
  return at->get<std::uint32_t>();
}

Result<const json*> list_of(const json& object, const char* name) {
  const auto at = object.find(name);
  if (at == object.end() || !at->is_array() || at->size() > kMostEntries)
    return fail(Fault::usage, std::string("`") + name + "` must be a list of at most " +
                                  std::to_string(kMostEntries) + " entries");
  return &*at;
}

}  // namespace

Result<Request> parse_text(std::string_view text) {
  if (text.size() > kLongestRequest) return fail(Fault::usage, "the request is too long");
  const auto parsed = parse_bounded_json(text);
  if (!parsed)
    return fail(Fault::usage, "the request is not a JSON object: " + parsed.error().message);
  const json& object = *parsed;
  if (!object.is_object()) return fail(Fault::usage, "the request is not a JSON object");
  const auto op = object.find("op");
  if (op == object.end() || !op->is_string()) return fail(Fault::usage, "the request has no `op`");
  const std::string& name = op->get_ref<const std::string&>();
  Request request;
  if (name == "subscribe") {
    const json* list = KAZ_TRY(list_of(object, "subscriptions"));
    for (const json& entry : *list) {
      const auto id = KAZ_TRY(number_of(entry, "id"));
      const auto channel = KAZ_TRY(number_of(entry, "channelId"));
      request.subscribe.push_back({id, channel});
    }
    return request;
  }
  if (name == "unsubscribe") {
    request.kind = Request::Kind::unsubscribe;
    const json* list = KAZ_TRY(list_of(object, "subscriptionIds"));
    for (const json& entry : *list) {
      const auto id = KAZ_TRY(number_of(json{{"id", entry}}, "id"));
      request.unsubscribe.push_back(id);
    }
    return request;
  }
  if (name == "fetchAsset") {
    request.kind = Request::Kind::fetch_asset;
    request.asset_request = KAZ_TRY(number_of(object, "requestId"));
    const auto uri = object.find("uri");
    if (uri == object.end() || !uri->is_string() ||
        uri->get_ref<const std::string&>().size() > kLongestName)
      return fail(Fault::usage,
                  "`uri` must be a text of at most " + std::to_string(kLongestName) + " bytes");
    request.uri = uri->get<std::string>();
    return request;
  }
  if (name == "getParameters") {
    request.kind = Request::Kind::parameters;
    const json* list = KAZ_TRY(list_of(object, "parameterNames"));
    for (const json& entry : *list) {
      if (!entry.is_string()) return fail(Fault::usage, "a parameter's name must be a text");
      request.parameters.push_back(entry.get<std::string>());
    }
    if (const auto id = object.find("id"); id != object.end() && id->is_string())
      request.parameters_request = id->get<std::string>();
    return request;
  }
  if (name == "advertise") {
    request.kind = Request::Kind::advertise;
    const json* list = KAZ_TRY(list_of(object, "channels"));
    for (const json& entry : *list) {
      const auto id = KAZ_TRY(number_of(entry, "id"));
      const auto topic = entry.find("topic"), encoding = entry.find("encoding");
      if (topic == entry.end() || *topic != kHandTopic || encoding == entry.end() ||
          *encoding != "json")
        return fail(Fault::usage, "viewers can publish on `" + std::string(kHandTopic) +
                                      "` only, with the encoding `json`");
      request.advertise.push_back(id);
    }
    return request;
  }
  if (name == "unadvertise") {
    request.kind = Request::Kind::unadvertise;
    const json* list = KAZ_TRY(list_of(object, "channelIds"));
    for (const json& entry : *list) {
      const auto id = KAZ_TRY(number_of(json{{"id", entry}}, "id"));
      request.unadvertise.push_back(id);
    }
    return request;
  }
  // They never change.
  if (name == "subscribeParameterUpdates" || name == "unsubscribeParameterUpdates") {
    request.kind = Request::Kind::watch_parameters;
    return request;
  }
  if (name == "setParameters") return fail(Fault::usage, "parameters are read-only");
  return fail(
      Fault::usage,
      "unknown request: use subscribe, unsubscribe, fetchAsset, getParameters, advertise or "
      "unadvertise");
}

Result<Request> parse_binary(std::span<const std::uint8_t> bytes) {
  LittleEndianFields fields(bytes);
  const auto opcode = fields.number<std::uint8_t>();
  Request request;
  if (opcode == kPublish) {
    request.kind = Request::Kind::publish;
    request.published = fields.number<std::uint32_t>();
    const auto rest = fields.rest();
    const std::string_view text(reinterpret_cast<const char*>(rest.data()), rest.size());
    const json object = fields.good() && text.size() <= kLongestRequest
                            ? parse_bounded_json(text).value_or(nullptr)
                            : json();
    const auto line = object.is_object() ? object.find("do") : object.end();
    if (!object.is_object() || line == object.end() || !line->is_string() ||
        line->get_ref<const std::string&>().size() > kLongestLine)
      return fail(Fault::usage,
                  "a published message must be {\"do\": LINE}; LINE may have at most " +
                      std::to_string(kLongestLine) + " bytes");
    request.line = line->get<std::string>();
    return request;
  }
  if (opcode != kPlaybackRequest)
    return fail(Fault::usage, "unknown binary request: use a message or a player's request");
  request.kind = Request::Kind::playback;
  Playback& playback = request.playback;
  const auto command = fields.number<std::uint8_t>();
  playback.command = Playback::Command{command};
  playback.speed = std::bit_cast<float>(fields.number<std::uint32_t>());
  const auto seek = fields.number<std::uint8_t>();
  playback.seek = seek != 0;
  playback.seek_ns = fields.number<std::uint64_t>();
  playback.request = fields.text();
  if (!fields.good() || !fields.rest().empty() || command > 1 || seek > 1 ||
      playback.request.size() > kLongestName || !(playback.speed >= 0.01) ||
      !(playback.speed <= 100.01))
    return fail(Fault::usage,
                "the player's request has a wrong length or value: the speed must be 0.01 to 100");
  return request;
}

std::string_view chosen_subprotocol(std::string_view offered) {
  for (const std::string_view ours : kSubprotocols) {
    for (std::string_view rest = offered; !rest.empty();) {
      const auto comma = rest.find(',');
      std::string_view word = rest.substr(0, comma);
      rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
      const auto begin = word.find_first_not_of(" \t");
      if (begin == std::string_view::npos) continue;
      word = word.substr(begin, word.find_last_not_of(" \t") + 1 - begin);
      if (word == ours) return ours;
    }
  }
  return {};
}

bool understands(std::string_view subprotocol, std::uint8_t opcode) {
  return opcode != kPlaybackState || subprotocol == kSdkProtocol;
}

std::string server_info(const std::string& name, const std::string& session,
                        std::string_view subprotocol, std::vector<std::string> capabilities,
                        std::uint64_t start_ns, std::uint64_t end_ns) {
  const bool sdk = subprotocol == kSdkProtocol;
  if (!sdk) std::erase(capabilities, "playbackControl");
  nlohmann::ordered_json info{
      {"op", "serverInfo"},           {"name", name},
      {"capabilities", capabilities}, {"supportedEncodings", json::array({"json"})},
      {"metadata", json::object()},   {"sessionId", session}};
  const auto time = [](std::uint64_t ns) {
    return json{{"sec", ns / 1'000'000'000}, {"nsec", ns % 1'000'000'000}};
  };
  if (sdk && end_ns > 0) {
    info["dataStartTime"] = time(start_ns);
    info["dataEndTime"] = time(end_ns);
  }
  return info.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string advertisement(std::span<const Channel> channels) {
  auto list = nlohmann::ordered_json::array();
  for (const Channel& channel : channels)
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", channel.encoding},
                    {"schemaName", channel.schema_name},
                    {"schema", channel.schema},
                    {"schemaEncoding", channel.schema_encoding}});
  return nlohmann::ordered_json{{"op", "advertise"}, {"channels", list}}.dump();
}

std::string parameter_values(const std::map<std::string, std::string>& values,
                             const std::string& request) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& [name, value] : values) list.push_back({{"name", name}, {"value", value}});
  nlohmann::ordered_json reply{{"op", "parameterValues"}, {"parameters", list}};
  if (!request.empty()) reply["id"] = request;
  return reply.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string status(StatusLevel level, const std::string& sentence) {
  return nlohmann::ordered_json{
      {"op", "status"}, {"level", static_cast<int>(level)}, {"message", sentence}}
      .dump(-1, ' ', false, json::error_handler_t::replace);
}

Bytes message_head(std::uint32_t subscription, std::uint64_t time_ns) {
  Bytes frame;
  LittleEndian(frame).number(kMessage).number(subscription).number(time_ns);
  return frame;
}

Bytes time_frame(std::uint64_t time_ns) {
  Bytes frame;
  LittleEndian(frame).number(kTime).number(time_ns);
  return frame;
}

Bytes asset_head(std::uint32_t request, const std::string& error) {
  Bytes frame;
  LittleEndian(frame)
      .number(kAsset)
      .number(request)
      .number(static_cast<std::uint8_t>(error.empty() ? 0 : 1))
      .text(error);
  return frame;
}

Bytes playback_frame(const PlaybackState& state) {
  Bytes frame;
  LittleEndian(frame)
      .number(kPlaybackState)
      .number(static_cast<std::uint8_t>(state.status))
      .number(state.time_ns)
      .number(std::bit_cast<std::uint32_t>(static_cast<float>(state.speed)))
      .number(static_cast<std::uint8_t>(state.sought))
      .text(state.request);
  return frame;
}

}  // namespace kaz::viewer
