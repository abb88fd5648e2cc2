// How a run was put together, as its recording states it.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/replay/recorded_backend.h"

#include <nlohmann/json.hpp>

#include "shared/base/json_depth.hpp"

namespace kaz::tools {
namespace {

using Json = nlohmann::json;

// Nothing where the text is no JSON object.
Json object_of(const std::string& text) {
  if (json_too_deep(text)) return {};
  return Json::parse(text, nullptr, false);
}

}  // namespace

Result<RecordedBackend> recorded_backend(const sim::McapRecording& recording,
                                         const std::string& name) {
  const auto fact = [&](const char* key) {
    const auto found = recording.facts.find(key);
    return found == recording.facts.end() ? std::string() : found->second;
  };
  const auto wrong = [&](const std::string& why) {
    return fail(Fault::usage,
                name + ": " + why + "; give a recording of this version's `kaz run` or `kaz demo`");
  };
  const Json backend = object_of(fact("backend")), settings = object_of(fact("settings"));
  RecordedBackend result;
  result.behavior = fact("behavior");
  if (result.behavior.empty() || !backend.is_object() || !settings.is_object())
    return wrong("it does not say which behaviour ran");
  for (const auto& [key, value] : settings.items()) {
    if (!value.is_string()) return wrong("the setting `" + key + "` of its behaviour is no text");
    result.settings[key] = value.get<std::string>();
  }
  std::string misfit;
  const auto take = [&](const char* key, auto& to, bool fits) {
    const auto found = backend.find(key);
    if (found == backend.end()) return;
    if (fits) {
      found->get_to(to);
    } else {
      misfit = key;
    }
  };
  const auto is = [&](const char* key, auto test) {
    const auto found = backend.find(key);
    return found != backend.end() && test(*found);
  };
  const auto text = [](const Json& value) { return value.is_string(); };
  const auto number = [](const Json& value) { return value.is_number(); };
  // "engine": the key of `mcu` in older recordings.
  for (const auto& [key, to] :
       {std::pair{"world", &result.world}, std::pair{"robot_file", &result.robot_file},
        std::pair{"engine", &result.mcu}, std::pair{"mcu", &result.mcu},
        std::pair{"image", &result.image}, std::pair{"sensors", &result.sensors},
        std::pair{"eyes", &result.eyes}, std::pair{"dynamics", &result.dynamics}})
    take(key, *to, is(key, text));
  take("imu", result.imu, is("imu", [](const Json& value) { return value.is_boolean(); }));
  take("physics_step_ms", result.physics_step_ms, is("physics_step_ms", number));
  take("supply_volts", result.supply_volts, is("supply_volts", number));
  take("eye_width", result.eye_width, is("eye_width", [](const Json& value) {
         return value.is_number_unsigned() && value.get<std::uint64_t>() <= 4096;
       }));
  take("seed", result.seed,
       is("seed", [](const Json& value) { return value.is_number_unsigned(); }));
  if (!misfit.empty())
    return wrong("`" + misfit + "` of its backend is not of the kind that it is");
  return result;
}

}  // namespace kaz::tools
