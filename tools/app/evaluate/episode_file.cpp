// The files of a campaign as they are read back.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/evaluate/episode_file.h"

#include "shared/base/json_depth.hpp"

namespace kaz::tools {
namespace {

using Json = nlohmann::ordered_json;

Result<Json> parse_object(const std::string& text, const std::string& name) {
  Json json = json_too_deep(text) ? Json() : Json::parse(text, nullptr, false);
  if (!json.is_object())
    return fail(Fault::usage, name + ": is damaged; remove it and run the campaign again");
  return json;
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

constexpr Field kFields[] = {{"episode", [](const Json& v) { return v.is_number_unsigned(); }},
                             {"scenario", has_seed},
                             {"success", [](const Json& v) { return v.is_boolean(); }},
                             {"cause", is_text},
                             {"sentence", is_text},
                             {"seconds", is_number, false},  // absent: not measured
                             {"rtf", is_number, false},
                             {"measurements", is_object},
                             {"truth", is_truth}};

}  // namespace

Result<Json> parse_campaign(const std::string& text, const std::string& name) {
  auto json = parse_object(text, name);
  if (!json) return json;
  if (!json->contains("behavior") || !(*json)["behavior"].is_string())
    return fail(Fault::usage, name + ": is no campaign, it names no behaviour; remove it");
  return json;
}

Result<Json> parse_episode(const std::string& text, const std::string& name) {
  auto json = parse_object(text, name);
  if (!json) return json;
  for (const Field& field : kFields) {
    const auto found = json->find(field.name);
    if (found == json->end() && !field.required) continue;
    if (found == json->end() || !field.fits(*found))
      return fail(Fault::usage, name + ": is no episode, its `" + field.name +
                                    "` is missing or of another kind; remove it");
  }
  return json;
}

}  // namespace kaz::tools
