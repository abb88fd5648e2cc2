// The golden vectors of vectors.json, which another codec made, through the C codec both ways.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "shared/protocol/messages.h"

namespace {

using nlohmann::json;
using Bytes = std::vector<u8>;

const json& vectors() {
  static const json data = [] {
    std::ifstream file("shared/protocol/vectors.json");
    return json::parse(file, nullptr, false);
  }();
  return data;
}

Bytes bytes_of(const json& hex) {
  const std::string text = hex.get<std::string>();
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    bytes.push_back(static_cast<u8>(std::stoi(text.substr(i, 2), nullptr, 16)));
  return bytes;
}

// Names of results, and of errors of bytes.
const std::map<int, std::string> kResults = {{KZ_RECEIVE_FRAME, "FRAME"},
                                             {KZ_RECEIVE_BAD_CHECK, "BAD_CHECK"},
                                             {KZ_RECEIVE_BAD_STUFFING, "BAD_STUFFING"},
                                             {KZ_RECEIVE_TOO_SHORT, "TOO_SHORT"},
                                             {KZ_RECEIVE_TOO_LONG, "TOO_LONG"},
                                             {KZ_RECEIVE_LINE_ERROR, "LINE_ERROR"},
                                             {KZ_RECEIVE_OVERRUN, "OVERRUN"},
                                             {KZ_RECEIVE_IDLE, "IDLE"}};
const std::map<std::string, u8> kErrors = {{"OVERRUN", KZ_RX_OVERRUN},
                                           {"FRAMING", KZ_RX_FRAMING},
                                           {"PARITY", KZ_RX_PARITY},
                                           {"LOST", KZ_RX_LOST}};

std::string hex_of(const u8* bytes, std::size_t length) {
  std::string text;
  for (std::size_t i = 0; i < length; ++i) {
    text += "0123456789abcdef"[bytes[i] >> 4];
    text += "0123456789abcdef"[bytes[i] & 15];
  }
  return text;
}

// What a receiver makes of a stream, as the vectors tell it.
json received(const json& stream) {
  const Bytes wire = bytes_of(stream["wire"]);
  std::map<std::size_t, u8> error_at;
  std::map<std::size_t, int> silence_at;
  for (const json& error : stream.value("errors", json::array()))
    error_at[error[0]] = kErrors.at(error[1]);
  for (const json& silence : stream.value("silence_ms", json::array()))
    silence_at[silence[0]] = silence[1];
  json found = json::array();
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  const auto note = [&](u8 result) {
    if (result == KZ_RECEIVE_MORE) return;
    found.push_back({kResults.at(result)});
    if (result == KZ_RECEIVE_FRAME) found.back().push_back(hex_of(receiver.body, receiver.length));
  };
  for (std::size_t i = 0; i < wire.size(); ++i) {
    for (int ms = silence_at[i]; ms != 0; --ms) note(kz_receiver_silent(&receiver));
    receiver.silent_ms = 0;
    note(kz_receive(&receiver, wire[i], error_at[i]));
  }
  return found;
}

// The body of the only frame on the wire; empty if there is not just one.
Bytes body_of(const Bytes& wire) {
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  Bytes body;
  for (const u8 byte : wire) {
    const u8 result = kz_receive(&receiver, byte, 0);
    if (result == KZ_RECEIVE_MORE) continue;
    if (result != KZ_RECEIVE_FRAME || !body.empty()) return {};
    body.assign(receiver.body, receiver.body + receiver.length);
  }
  return body;
}

Bytes frame_of(const Bytes& body) {
  Bytes wire(KZ_FRAME_MAX);
  wire.resize(kz_frame_encode(body.data(), static_cast<u8>(body.size()), wire.data()));
  return wire;
}

// ---- A codec from JSON to the structs, by the message table

template <typename T>
void numbers_of(const json& values, T* numbers, int count) {
  ASSERT_EQ(static_cast<int>(values.size()), count);
  for (int i = 0; i < count; ++i) numbers[i] = values[static_cast<std::size_t>(i)].get<T>();
}

template <typename T>
void masked_of(const json& values, u32 mask, int most, T* numbers) {
  std::size_t next = 0;
  for (int joint = 0; joint < KZ_JOINTS; ++joint)
    if (mask >> joint & 1 && static_cast<int>(next) < most) numbers[joint] = values.at(next++);
  ASSERT_EQ(next, values.size());
}

template <typename T>
json masked_json(u32 mask, int most, const T* numbers) {
  json values = json::array();
  for (int joint = 0; joint < KZ_JOINTS; ++joint)
    if (mask >> joint & 1 && static_cast<int>(values.size()) < most)
      values.push_back(numbers[joint]);
  return values;
}

struct Codec {
  Bytes (*pack)(const json& fields);
  json (*unpack)(const Bytes& fields, int* out_of_bounds);  // null if the length is wrong
};

#define KZ_MESSAGE(name, code, kind, text)                  \
  Bytes packed(const kz_##name& message) {                  \
    Bytes fields(KZ_PAYLOAD_MAX);                           \
    fields.resize(kz_pack_##name(&message, fields.data())); \
    return fields;                                          \
  }
#include "shared/protocol/messages.def"

#define KZ_MESSAGE(name, code, kind, text) \
  Bytes pack_##name(const json& fields) {  \
    kz_##name message = {};                \
    (void)fields;
#define KZ_FIELD(type, name, unit, text) message.name = fields[#name].get<type>();
#define KZ_ARRAY(type, name, count, unit, text) numbers_of(fields[#name], message.name, count);
#define KZ_MASKED(type, name, mask_name, most, unit, text) \
  masked_of(fields[#name], message.mask_name, most, message.name);
#define KZ_END()          \
  return packed(message); \
  }
#include "shared/protocol/messages.def"

#define KZ_MESSAGE(name, code, kind, text)                                                   \
  json unpack_##name(const Bytes& bytes, int* out_of_bounds) {                               \
    kz_##name message;                                                                       \
    json fields = json::object();                                                            \
    if (!kz_unpack_##name(&message, bytes.data(), static_cast<u8>(bytes.size()))) return {}; \
    *out_of_bounds = kz_check_##name(&message);
#define KZ_FIELD(type, name, unit, text) fields[#name] = message.name;
#define KZ_ARRAY(type, name, count, unit, text) fields[#name] = message.name;
#define KZ_MASKED(type, name, mask_name, most, unit, text) \
  fields[#name] = masked_json(message.mask_name, most, message.name);
#define KZ_END() \
  return fields; \
  }
#include "shared/protocol/messages.def"

const std::map<std::string, Codec> kCodecs = {
#define KZ_MESSAGE(name, code, kind, text) {#name, {pack_##name, unpack_##name}},
#include "shared/protocol/messages.def"
};

TEST(Vectors, ThereAreEnoughOfEveryKind) {
  ASSERT_TRUE(vectors().is_object());
  EXPECT_GE(vectors()["messages"].size() + vectors()["bodies"].size() + vectors()["streams"].size(),
            500u);
  std::set<std::string> messages, seen;
  for (const json& vector : vectors()["messages"]) messages.insert(vector["message"]);
  EXPECT_EQ(messages.size(), kCodecs.size());
  for (const json& stream : vectors()["streams"])
    for (const json& result : stream["results"]) seen.insert(result[0]);
  EXPECT_EQ(seen.size(), kResults.size());
}

TEST(Vectors, MessagesBothWays) {
  for (const json& vector : vectors()["messages"]) {
    SCOPED_TRACE(vector["name"]);
    const Codec& codec = kCodecs.at(vector["message"]);
    const Bytes body = bytes_of(vector["body"]);
    ASSERT_GE(body.size(), std::size_t{KZ_HEADER_SIZE});
    EXPECT_EQ(body[0], vector["address"]);
    EXPECT_EQ(body[2], vector["sequence"]);
    const Bytes bytes(body.begin() + KZ_HEADER_SIZE, body.end());
    EXPECT_EQ(codec.pack(vector["fields"]), bytes);
    int field = -1;
    EXPECT_EQ(codec.unpack(bytes, &field), vector["fields"]);
    const json& expected = vector["out_of_bounds"];
    EXPECT_EQ(field, expected.is_null() ? KZ_IN_BOUNDS : expected.get<int>());
  }
}

TEST(Vectors, FramesBothWays) {
  for (const char* part : {"messages", "bodies"}) {
    for (const json& vector : vectors()[part]) {
      SCOPED_TRACE(vector["name"]);
      EXPECT_EQ(frame_of(bytes_of(vector["body"])), bytes_of(vector["wire"]));
      EXPECT_EQ(body_of(bytes_of(vector["wire"])), bytes_of(vector["body"]));
    }
  }
}

TEST(Vectors, StreamsGiveTheResultsExpected) {
  for (const json& stream : vectors()["streams"])
    EXPECT_EQ(received(stream), stream["results"]) << stream["name"];
}

}  // namespace
