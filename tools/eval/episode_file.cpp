// The files of a campaign as they are read back.
// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/episode_file.h"

#include <algorithm>
#include <span>

#include "shared/base/bounded_json.hpp"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

Result<Json> parse_object(const std::string& text, const std::string& name) {
  Result<Json> json = parse_bounded_json<Json>(text);
  if (json && json->is_object()) return json;
  const std::string why = json ? "not a JSON object" : json.error().message;
  return fail(Fault::usage,
              name + ": is damaged (" + why + "); remove the file and run the campaign again");
}

struct Field {
  const char* name;
  bool (*fits)(const Json&);
  bool required = true;
};

bool is_text(const Json& value) {
  return value.is_string();
}
bool is_number(const Json& value) {
  return value.is_number();
}
bool is_object(const Json& value) {
  return value.is_object();
}
bool has_seed(const Json& value) {
  return value.is_object() && value.contains("seed") && value["seed"].is_number_unsigned();
}
bool is_truth(const Json& value) {
  return value.is_object() && (!value.contains("fell") || value["fell"].is_boolean());
}

bool is_flag(const Json& value) {
  return value.is_boolean();
}
bool is_planned(const Json& value) {
  constexpr std::uint64_t kMaxEpisodes = 1'000'000;  // of --episodes
  for (const char* key : {"episodes", "shard", "shards"})
    if (!value.is_object() || !value.contains(key) || !value[key].is_number_unsigned() ||
        value[key].get<std::uint64_t>() == 0)
      return false;
  return value["episodes"].get<std::uint64_t>() <= kMaxEpisodes &&
         value["shard"].get<std::uint64_t>() <= value["shards"].get<std::uint64_t>();
}
bool is_lost(const Json& value) {
  const auto one = [](const Json& v) {
    return v.is_object() && v.contains("episode") && v["episode"].is_number_unsigned() &&
           v.contains("sentence") && v["sentence"].is_string();
  };
  return value.is_array() && std::all_of(value.begin(), value.end(), one);
}

constexpr Field kResultFields[] = {{"planned", is_planned, false},  // absent in earlier versions
                                   {"environment", is_lost, false},
                                   {"interrupted", is_flag, false},
                                   {"signal", is_text, false}};
constexpr Field kEpisodeFields[] = {
    {"episode", [](const Json& v) { return v.is_number_unsigned(); }},
    {"scenario", has_seed},
    {"success", [](const Json& v) { return v.is_boolean(); }},
    {"claim", is_flag, false},   // absent in earlier versions
    {"judged", is_flag, false},  // false: not by truth alone; absent: true
    {"cause", is_text},
    {"sentence", is_text},
    {"seconds", is_number, false},  // absent: not measured
    {"rtf", is_number, false},
    {"measurements", is_object},
    {"truth", is_truth}};

// Returns `json` if its fields are valid. `what`: kind of the file, for the error.
Result<Json> checked(Result<Json> json, std::span<const Field> fields, const std::string& name,
                     const std::string& what) {
  if (!json) return json;
  for (const Field& field : fields) {
    const auto found = json->find(field.name);
    if (found == json->end() && !field.required) continue;
    if (found == json->end() || !field.fits(*found))
      return fail(Fault::usage, name + ": invalid " + what + ": `" + field.name +
                                    "` is missing or invalid; remove the file");
  }
  return json;
}

}  // namespace

Result<Json> parse_campaign(const std::string& text, const std::string& name) {
  auto json = parse_object(text, name);
  if (!json) return json;
  if (!json->contains("behavior") || !(*json)["behavior"].is_string())
    return fail(Fault::usage,
                name + ": not a campaign: `behavior` is missing or invalid; remove the file");
  return json;
}

Result<Json> parse_episode(const std::string& text, const std::string& name) {
  return checked(parse_object(text, name), kEpisodeFields, name, "episode");
}

Result<Json> parse_result(const std::string& text, const std::string& name) {
  return checked(parse_object(text, name), kResultFields, name, "result of kaz evaluate");
}

}  // namespace kaz::tools
